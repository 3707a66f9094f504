import java.util.Map;
import java.util.OptionalLong;

/**
 * Your node goes here, or the bridge to it. Whatever is marked TODO is yours to write.
 *
 * It has no clock of its own: Adapter says what time it is (ticks of 1/1024 s), gives it what
 * happens, and calls runDue() when due() says so.
 */
final class MyNode {
    private final World world;
    private final long startedAt;
    private int nextNumber;
    private long now;

    /** One that has just started. settings has id, island, channels and profile. */
    MyNode(World world, String role, Map<String, String> settings, int nextNumber, long now) {
        this.world = world;
        this.nextNumber = nextNumber;
        this.now = now;
        this.startedAt = now;
        // TODO: which node you are, and with which id or island.
    }

    void setTime(long ticks) {
        now = ticks;
    }

    /** When something happens by itself; empty: never. */
    OptionalLong due() {
        return OptionalLong.empty(); // TODO: the soonest of your timers.
    }

    /** Does what is due now. */
    void runDue() {
        // TODO: what your timers do.
    }

    /** A frame came, whoever it is for. */
    void heard(String line, byte[] packet) {
        // TODO: hand it to your receiver.
    }

    /** Somebody else has the line, or left it. "app": the application takes no messages. */
    void setBusy(String line, boolean busy) {
        // TODO: what is to be sent, or handed up, waits meanwhile.
    }

    /** Handles the end of the transmission that asked for a link ack. */
    void confirmed(boolean acked) {
        // TODO: if you ask for any.
    }

    /** A call of the application. False: not there, and the cases that need it are skipped. */
    boolean call(String name, Map<String, String> arguments) {
        // TODO: "join" has arguments type, transducers and actuators, and so on.
        if (name.equals("get_clock")) {
            world.up("clock(" + (now - startedAt) * 1000 / 1024 + ")");
            return true;
        }
        return false;
    }

    /** The one thing that outlives a loss of power. */
    int nextNumber() {
        return nextNumber;
    }
}
