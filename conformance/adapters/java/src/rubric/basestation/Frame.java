package rubric.basestation;

import java.nio.ByteBuffer;
import java.util.Arrays;
import rubric.wire.Wire;
import rubric.wire.WireException;
import rubric.wire.WireException.Fault;
import rubric.wire.tinyos.AmHeader;

/**
 * An active message on a line. Over PEIS dest and src are islands.
 */
public record Frame(Link link, int dest, int src, int type, byte[] payload) {
  /** The packet of the serial forwarder: dispatch byte, header, payload. */
  public byte[] toPacket() {
    final AmHeader.Writer header =
        new AmHeader.Writer().dest(dest).src(src).length(payload.length).type(type);
    final ByteBuffer out = ByteBuffer.allocate(AmHeader.MAX_SIZE_BYTES + payload.length);
    try {
      header.writeTo(out);
    } catch (WireException e) { // Payloads of ours are not that long.
      throw new IllegalStateException(e);
    }
    return out.put(payload).array();
  }

  /** Returns a packet from `link` without the bytes after its length; throws if it is shorter. */
  public static Frame parse(Link link, byte[] packet) throws WireException {
    final AmHeader header = AmHeader.parse(ByteBuffer.wrap(packet));
    final byte[] behind = Wire.copy(header.stale());
    if (behind.length < header.length()) {
      throw new WireException(Fault.TRUNCATED, packet.length, "WIRE-AM-LENGTH");
    }
    return new Frame(link, header.dest(), header.src(), header.type(),
        Arrays.copyOf(behind, header.length()));
  }
}
