/** Outputs of the node to its world. */
interface World {
    /**
     * A frame leaves by "radio", "serial" or "peis": 00, destination, source, length, group, type,
     * payload. linkAck asks for the radio's own acknowledgement: MyNode.confirmed follows.
     */
    void tx(String line, byte[] packet, boolean linkAck);

    /** News for the application, as "received(11:5 5 x0a0b)". */
    void up(String news);
}
