package rubric.wire.oddities;

import java.nio.ByteBuffer;
import rubric.wire.WireException;
import rubric.wire.WireView;
import rubric.wire.WireWriter;
import rubric.wire.odd.String_;
import rubric.wire.odd.Tail;
import rubric.wire.odd.Writer_;

/** Tests the code from odd.ksy: names, computed sizes, optional fields, signs and orders. */
public final class OddTest {
  private static int failures = 0;

  public static void main(String[] args) throws WireException {
    // count 3: flags are there, (7 - 3) * 2 + 1 = 9 numbers.
    final Writer_ all =
        Writer_.parse(bytes("fbff 03 ffffffff 01020304 ff02ff02ff02ff02ff 3fc00000"));
    expect("Writer{value=-5, count=3, flags=4294967295, out=String_{byte=1, get_class=2, import=3, "
        + "size_bytes_2=4}, in=[-1, 2, -1, 2, -1, 2, -1, 2, -1], rest=[1.5]}",
        all.toString().replace("Writer_{", "Writer{"));
    expect(1, all.out().byte_());
    rewritten(all);
    // count 7: no flags, one number, no floats.
    final Writer_ least = Writer_.parse(bytes("2c01 07 01020304 02"));
    expect("Writer_{value=300, count=7, out=String_{byte=1, get_class=2, import=3, "
        + "size_bytes_2=4}, in=[2], rest=[]}", least.toString());
    expect(false, least.hasFlags());
    rewritten(least);
    refused("out_of_range at byte 0", () -> Writer_.parse(bytes("faff 07 01020304 02")));
    refused("out_of_range at byte 2", () -> Writer_.parse(bytes("0000 08 01020304 02")));
    refused("unexpected at byte 7", () -> Writer_.parse(bytes("0000 07 01020304 01")));
    refused("truncated at byte 7", () -> Writer_.parse(bytes("0000 07 01020304")));
    refused("truncated at byte 10", () -> Writer_.parse(bytes("0000 07 01020304 02 0000")));
    expect(10, Writer_.parse(bytes("0000 06 01020304 0202ff")).sizeBytes());
    refused("truncated at byte 9", () -> Writer_.parse(bytes("0000 06 01020304 02ff")));
    // Pairs are half of size, rounded down.
    final Tail tail = Tail.parse(bytes("05 01020304 05060708 99"));
    expect(2, tail.pairs().size());
    expect(8, tail.pairs().get(1).sizeBytes2());
    expect(1, tail.stale().remaining());
    rewritten(tail);
    refused("out_of_range at byte 9", new Tail.Writer().size(5).pairs(
        java.util.List.of(pair(), pair(), pair()))::toBytes);
    refused("truncated at byte 5", new Tail.Writer().size(5).pairs(
        java.util.List.of(pair()))::toBytes);
    System.out.println(failures + " failures");
    System.exit(failures == 0 ? 0 : 1);
  }

  private interface Attempt {
    Object run() throws WireException;
  }

  private static String_.Writer pair() {
    return new String_.Writer().import_(1);
  }

  private static ByteBuffer bytes(String hex) {
    final String digits = hex.replace(" ", "");
    final ByteBuffer out = ByteBuffer.allocate(digits.length() / 2);
    for (int i = 0; i < digits.length(); i += 2) {
      out.put((byte) Integer.parseInt(digits.substring(i, i + 2), 16));
    }
    return out.flip();
  }

  private static void rewritten(WireView view) throws WireException {
    final WireWriter writer = view.toWriter();
    expect(view.bytes(), writer.toBytes());
  }

  private static void refused(String expected, Attempt attempt) {
    try {
      expect(expected, "accepted: " + attempt.run());
    } catch (WireException e) {
      expect(expected + ": WIRE-APP-HEADER", e.getMessage());
    }
  }

  private static void expect(Object expected, Object found) {
    if (expected.equals(found)) return;
    ++failures;
    System.err.println(found + ", not " + expected);
  }
}
