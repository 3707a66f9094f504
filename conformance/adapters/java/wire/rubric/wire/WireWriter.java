package rubric.wire;

import java.nio.ByteBuffer;
import rubric.wire.WireException.Fault;

/** The values of a structure, to be written. What parse would refuse is refused. */
public abstract class WireWriter {
  private final WireCheck rules;
  private final String requirement;

  protected WireWriter(WireCheck rules, String requirement) {
    this.rules = rules;
    this.requirement = requirement;
  }

  /** A step of writing, which does not look at the whole; use toBytes() or writeTo(). */
  public abstract void store(WireOutput out) throws WireException;

  /** The structure's bytes. */
  public final ByteBuffer toBytes() throws WireException {
    final WireOutput out = new WireOutput();
    store(out);
    final WireReader in = new WireReader(out.bytes());
    rules.check(in);
    if (in.taken() != out.size()) { // A length elsewhere in it promises less.
      throw new WireException(Fault.OUT_OF_RANGE, in.taken(), requirement);
    }
    return out.bytes();
  }

  /**
   * Puts the structure's bytes at the position of `out` and moves that past them.
   *
   * @throws java.nio.BufferOverflowException if there is no room; nothing is written then
   */
  public final void writeTo(ByteBuffer out) throws WireException {
    out.put(toBytes());
  }
}
