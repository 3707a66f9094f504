package rubric.wire;

import java.nio.ByteBuffer;
import rubric.wire.WireException.Fault;

/**
 * Goes through the bytes of a structure once, from the first to the last, and throws at the first
 * that breaks a rule.
 */
public final class WireReader {
  private final ByteBuffer bytes;
  private final int offset; // The structure's, in the parsed bytes.
  private int end;
  private int at = 0;
  // The number that was taken last.
  private long value = 0;
  private int valueAt = 0;
  private String valueRule = "";

  public WireReader(ByteBuffer bytes) {
    this(bytes.slice(), 0);
  }

  private WireReader(ByteBuffer bytes, int offset) {
    this.bytes = bytes;
    this.offset = offset;
    this.end = bytes.remaining();
  }

  /** All that the structure was given; index 0 is its first byte. */
  public ByteBuffer bytes() {
    return bytes;
  }

  public CheckedBytes checked() {
    return new CheckedBytes(bytes.duplicate().position(0).limit(end));
  }

  /** Returns how many bytes were taken so far. */
  public int taken() {
    return at;
  }

  /** Leaves out bytes after the structure's greatest size. */
  public void atMost(int sizeBytes) {
    end = Math.min(end, sizeBytes);
  }

  public WireReader skip(long sizeBytes, String requirement) throws WireException {
    if (sizeBytes > end - at) throw new WireException(Fault.TRUNCATED, offset + end, requirement);
    at += (int) sizeBytes;
    return this;
  }

  /** The next bytes, for what they hold. */
  public WireReader part(long sizeBytes, String requirement) throws WireException {
    final int from = at;
    skip(sizeBytes, requirement);
    return new WireReader(bytes.slice(from, at - from), offset + from);
  }

  /** All bytes that are left, for what they hold. */
  public WireReader rest() {
    final int from = at;
    at = end;
    return new WireReader(bytes.slice(from, at - from), offset + from);
  }

  /** A structure that is as large as itself. */
  public void nested(WireCheck structure) throws WireException {
    final WireReader inner = new WireReader(bytes.slice(at, end - at), offset + at);
    structure.check(inner);
    at += inner.at;
  }

  /** Structures up to the end. */
  public void each(WireCheck structure) throws WireException {
    while (at < end) nested(structure);
  }

  public boolean hasMore() {
    return at < end;
  }

  /** Checks that elements of `unit` bytes fill the bytes that are left. */
  public WireReader multiple(int unit, String requirement) throws WireException {
    if ((end - at) % unit == 0) return this;
    throw new WireException(Fault.TRUNCATED, offset + end, requirement);
  }

  public WireReader u1(String requirement) throws WireException {
    return take(1, requirement).number(Wire.u1(bytes, valueAt));
  }

  public WireReader u2be(String requirement) throws WireException {
    return take(2, requirement).number(Wire.u2be(bytes, valueAt));
  }

  public WireReader u2le(String requirement) throws WireException {
    return take(2, requirement).number(Wire.u2le(bytes, valueAt));
  }

  public WireReader u4be(String requirement) throws WireException {
    return take(4, requirement).number(Wire.u4be(bytes, valueAt));
  }

  public WireReader u4le(String requirement) throws WireException {
    return take(4, requirement).number(Wire.u4le(bytes, valueAt));
  }

  public WireReader s1(String requirement) throws WireException {
    return take(1, requirement).number(Wire.s1(bytes, valueAt));
  }

  public WireReader s2be(String requirement) throws WireException {
    return take(2, requirement).number(Wire.s2be(bytes, valueAt));
  }

  public WireReader s2le(String requirement) throws WireException {
    return take(2, requirement).number(Wire.s2le(bytes, valueAt));
  }

  public WireReader s4be(String requirement) throws WireException {
    return take(4, requirement).number(Wire.s4be(bytes, valueAt));
  }

  public WireReader s4le(String requirement) throws WireException {
    return take(4, requirement).number(Wire.s4le(bytes, valueAt));
  }

  /** Checks the number that was taken last. */
  public void isFrom(long min, long max) throws WireException {
    if (value >= min && value <= max) return;
    throw new WireException(Fault.OUT_OF_RANGE, offset + valueAt, valueRule);
  }

  /** Checks the number that was taken last. */
  public void isOneOf(long... values) throws WireException {
    for (final long good : values) {
      if (value == good) return;
    }
    throw new WireException(Fault.UNEXPECTED, offset + valueAt, valueRule);
  }

  private WireReader take(int sizeBytes, String requirement) throws WireException {
    valueAt = at;
    valueRule = requirement;
    return skip(sizeBytes, requirement);
  }

  private WireReader number(long taken) {
    value = taken;
    return this;
  }
}
