package rubric.wire;

import java.io.ByteArrayOutputStream;
import java.nio.ByteBuffer;
import rubric.wire.WireException.Fault;

/** Collects the bytes of writers, one after the other. */
public final class WireOutput {
  private final ByteArrayOutputStream out = new ByteArrayOutputStream();

  /** Returns the number of bytes. */
  public int size() {
    return out.size();
  }

  /** Returns the bytes so far. */
  public ByteBuffer bytes() {
    return ByteBuffer.wrap(out.toByteArray());
  }

  /** `count`, which the next number will hold, if it may. */
  public int length(int count, long min, long max, String requirement) throws WireException {
    if (count >= min && count <= max) return count;
    throw new WireException(Fault.OUT_OF_RANGE, out.size(), requirement);
  }

  public void u1(long value) {
    out.write((int) value);
  }

  public void u2be(long value) {
    u1(value >> 8);
    u1(value);
  }

  public void u2le(long value) {
    u1(value);
    u1(value >> 8);
  }

  public void u4be(long value) {
    u2be(value >> 16);
    u2be(value);
  }

  public void u4le(long value) {
    u2le(value);
    u2le(value >> 16);
  }

  public void s1(long value) {
    u1(value);
  }

  public void s2be(long value) {
    u2be(value);
  }

  public void s2le(long value) {
    u2le(value);
  }

  public void s4be(long value) {
    u4be(value);
  }

  public void s4le(long value) {
    u4le(value);
  }

  public void f4be(float value) {
    u4be(Float.floatToRawIntBits(value));
  }

  public void f4le(float value) {
    u4le(Float.floatToRawIntBits(value));
  }

  public void bytes(byte[] values) {
    out.write(values, 0, values.length);
  }
}
