package rubric.basestation;

import java.util.Locale;

/** An output of a base station: a frame for a line, or news for the application. */
public sealed interface Action {
  /** The rule that it follows, such as "T2-ACK"; empty where no rule asks for it. */
  String rule();

  /**
   * A frame to put on a line now.
   *
   * @param awaits the number of the reliable message that it is, else SequenceNumbers.NONE
   */
  record Transmit(Frame frame, int awaits, String rule) implements Action {}

  /** News for the application. toString() is its text in traces. */
  sealed interface Notice extends Action {}

  /** The result of send: the number that the message carries, 0xFFFF if it was refused. */
  record SendResult(int seqNum, String rule) implements Notice {
    @Override
    public String toString() {
      return "send_result(" + seqNum + ")";
    }
  }

  /** A message for an application. */
  record Received(Address src, int appId, byte[] data, String rule) implements Notice {
    @Override
    public String toString() {
      return "received(" + src + " " + appId + " x" + Hex.of(data) + ")";
    }
  }

  /** The end of a reliable message. */
  record AckReceived(int appId, int seqNum, boolean success, String rule) implements Notice {
    @Override
    public String toString() {
      return "ack_received(" + appId + " " + seqNum + " " + text(success) + ")";
    }
  }

  /** The result of a call that returns nothing else. */
  record OperationResult(boolean success, String rule) implements Notice {
    @Override
    public String toString() {
      return "op_result(" + text(success) + ")";
    }
  }

  /** The answer to a call of synaptic channels, which a base station does not have. */
  record NoChannels(String text, String rule) implements Notice {
    @Override
    public String toString() {
      return text;
    }
  }

  /** An interface is switched on or off. */
  record InterfaceState(Link link, boolean on, String rule) implements Notice {
    @Override
    public String toString() {
      return "interface_state(" + link + " " + (on ? 1 : 0) + ")";
    }
  }

  /** The station's clock in milliseconds. */
  record Clock(long ms, String rule) implements Notice {
    @Override
    public String toString() {
      return String.format(Locale.ROOT, "clock(%d)", ms);
    }
  }

  /** The result of joinIsland, which a base station refuses: it is where it belongs. */
  record Joined(Address address, boolean success, String rule) implements Notice {
    @Override
    public String toString() {
      return "joined(" + address + " " + text(success) + ")";
    }
  }

  private static String text(boolean success) {
    return success ? "success" : "fail";
  }
}
