package rubric.basestation;

import rubric.wire.rubicon.Pid;
import rubric.wire.rubicon.RAddr;

/** An island and a device in it. (paper: The RUBICON Addressing Scheme) */
public record Address(int pid, int devid) {
  static Address of(RAddr wire) {
    return new Address(wire.pid(), wire.devid());
  }

  RAddr.Writer toWire() {
    return new RAddr.Writer().pid(pid).devid(devid);
  }

  /** Returns whether an id means no single island or mote. (decision 132) */
  static boolean isReserved(int id) {
    return id >= Pid.PROXY;
  }

  @Override
  public String toString() {
    return pid + ":" + devid;
  }
}
