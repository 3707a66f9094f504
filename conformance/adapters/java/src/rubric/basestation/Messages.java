package rubric.basestation;

import java.nio.ByteBuffer;
import java.util.Arrays;
import java.util.OptionalInt;
import rubric.wire.Wire;
import rubric.wire.WireException;
import rubric.wire.WireView;
import rubric.wire.rubicon.AmType;
import rubric.wire.rubicon.AppMsg;
import rubric.wire.rubicon.CommandCode;
import rubric.wire.rubicon.Component;
import rubric.wire.rubicon.Config;
import rubric.wire.rubicon.NetMsg;
import rubric.wire.rubicon.RubiconAck;
import rubric.wire.rubicon.RubiconAckSeqOnly;

/** Messages as bytes, and what bytes say. */
final class Messages {
  /** Bytes after TRANSID and APPID. */
  static final int DATA_MAX = 100;

  private Messages() {}

  /** A network message, as long as its payload. */
  static byte[] netMsg(Address dest, Address src, boolean reliable, int seqNum, int transId,
      int appId, byte[] data) {
    try {
      //= T1-WRAP: The payload of a net_msg begins with TRANSID CONNLESS and the APPID of the sender
      //= for what Connectionless.send was given.
      final ByteBuffer payload =
          new AppMsg.Writer().transId(transId).appId(appId).payload(data).toBytes();
      return Wire.copy(new NetMsg.Writer().dest(dest.toWire()).src(src.toWire())
          .reliable(reliable ? 1 : 0).seqNum(seqNum).payload(payload).toBytes());
    } catch (WireException e) { // The caller has checked the sizes.
      throw new IllegalStateException(e);
    }
  }

  /** On the serial line a network message always has its greatest length. */
  static byte[] padded(byte[] netMsg) {
    return Arrays.copyOf(netMsg, NetMsg.MAX_SIZE_BYTES);
  }

  /** Tells the sink its island. */
  static byte[] setIslandId(int island) {
    try {
      return Wire.copy(
          new Config.Writer().type(CommandCode.SET_ISLAND_ID).value(island).toBytes());
    } catch (WireException e) {
      throw new IllegalStateException(e);
    }
  }

  /** The body of an ack, as release 1.0 has it. (decision 108) */
  static byte[] ack(int seqNum) {
    try {
      return Wire.copy(new RubiconAck.Writer().type(AmType.LEARNING_NOTIFICATION).seqNum(seqNum)
          .toBytes());
    } catch (WireException e) {
      throw new IllegalStateException(e);
    }
  }

  /**
   * The number that an ack names, in either of its two forms. A sink that hands it on may have set
   * nbytes to its greatest, so that stale bytes follow. (decision 108)
   */
  static OptionalInt acked(AppMsg message) {
    final int size = message.payload().remaining();
    final WireView body = message.bodyView();
    if (body instanceof RubiconAckSeqOnly) {
      return size == 2 ? OptionalInt.of(((RubiconAckSeqOnly) body).seqNum()) : OptionalInt.empty();
    }
    if (!(body instanceof RubiconAck)) return OptionalInt.empty();
    final RubiconAck ack = (RubiconAck) body;
    if (ack.type() == AmType.LEARNING_NOTIFICATION) return OptionalInt.of(ack.seqNum());
    return size == DATA_MAX ? OptionalInt.of(Wire.u2be(message.payload(), 0))
        : OptionalInt.empty();
  }

  /** Returns whether the number is that of an application, above the transport level. */
  static boolean isApplication(int appId) {
    return appId == Component.MOCKUP || appId == Component.LEARNING
        || appId == Component.APPLICATION_MD || appId == Component.CONTROL_LAYER
        || appId == Component.ESN_DATA;
  }
}
