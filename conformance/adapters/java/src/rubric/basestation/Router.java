package rubric.basestation;

import java.util.Optional;
import rubric.wire.rubicon.Devid;
import rubric.wire.rubicon.Pid;

/** Routes messages: to the application, to the sink, to another island. */
final class Router {
  /** AM address and devid of every sink. */
  static final int SINK = 1;

  /** A way on: a line, the AM address there (of PEIS: the island), and the rule. */
  record Hop(Link link, int dest, String rule) {}

  private final Address own;

  Router(int island) {
    own = new Address(island, Devid.NULL);
  }

  /** The way of the station's own message; none where it is refused. */
  Optional<Hop> ofOwn(Address dest) {
    if (isElsewhere(dest)) return peis(dest);
    //= N4-SELF: A node refuses a message whose dest is the node itself.
    if (dest.devid() == Devid.NULL) return Optional.empty();
    if (dest.pid() == own.pid() && dest.devid() == Devid.LOCAL) return Optional.empty();
    //= N8-SERIAL: A base station sends a message for a mote of its own island over serial to its
    //= sink.
    return Optional.of(new Hop(Link.SERIAL, SINK, "N8-SERIAL"));
  }

  /** The way on of a message that came from `link`. */
  Optional<Hop> ofReceived(Link link, Address dest) {
    if (isElsewhere(dest)) {
      //= N8-LOOP: A base station does not hand a message for another island to its own sink.
      // Nor back to PEIS, where it would circulate.
      return link == Link.SERIAL ? peis(dest) : Optional.empty();
    }
    final boolean forMote = dest.pid() == own.pid() && dest.devid() != Devid.NULL;
    // Messages from the sink do not go down again.
    if (link == Link.SERIAL || !forMote) return Optional.empty();
    return Optional.of(new Hop(Link.SERIAL, SINK, "N8-INCOMING"));
  }

  /** Returns whether the message is for the station's application. */
  boolean isForUs(Address dest) {
    //= N8-DELIVER: A base station delivers a message with dest <its island, NULL> to its
    //= application.
    return !isElsewhere(dest) && (dest.devid() == Devid.NULL || dest.devid() == Devid.BROADCAST);
  }

  private boolean isElsewhere(Address dest) {
    return dest.pid() != own.pid() && dest.pid() != Pid.BROADCAST;
  }

  //= N8-PEIS: A base station sends a message for another island, its own or its sink's, through
  //= PEIS to that island's base station.
  private static Optional<Hop> peis(Address dest) {
    return Optional.of(new Hop(Link.PEIS, dest.pid(), "N8-PEIS"));
  }
}
