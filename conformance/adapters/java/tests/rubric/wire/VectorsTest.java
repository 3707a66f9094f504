package rubric.wire;

import java.io.IOException;
import java.nio.ByteBuffer;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.List;
import java.util.Locale;
import java.util.Map;
import java.util.TreeMap;
import java.util.stream.Stream;
import rubric.wire.rubicon.NetMsg;
import rubric.wire.rubicon.RAddr;
import rubric.wire.rubicon.Rubicon;
import rubric.wire.rubicon.SynapticData;

/**
 * The generated classes against spec/vectors: what is valid is read as it says and written as the
 * same bytes again, what is invalid is refused with the same fault.
 *
 * <p>Usage: VectorsTest FOLDER. Exit code 1 if something differs.
 */
public final class VectorsTest {
  private final Map<String, WireParser<?>> parsers = new TreeMap<>();
  private final List<String> failures = new ArrayList<>();
  private int valid = 0;
  private int invalid = 0;

  public static void main(String[] args) throws IOException {
    System.exit(new VectorsTest().run(Path.of(args[0])));
  }

  private VectorsTest() {
    rubric.wire.tinyos.Messages.PARSERS.forEach((k, v) -> parsers.put("tinyos." + k, v));
    rubric.wire.rubicon.Messages.PARSERS.forEach((k, v) -> parsers.put("rubicon." + k, v));
    rubric.wire.oscilloscope.Messages.PARSERS.forEach(
        (k, v) -> parsers.put("oscilloscope." + k, v));
  }

  private int run(Path folder) throws IOException {
    final List<Path> files;
    try (Stream<Path> all = Files.walk(folder)) {
      files = all.filter(f -> f.toString().endsWith(".yaml")).sorted().toList();
    }
    final Map<String, Integer> left = new TreeMap<>();
    parsers.keySet().forEach(name -> left.put(name + " valid", 1));
    parsers.keySet().forEach(name -> left.put(name + " invalid", 1));
    for (final Path file : files) {
      final VectorFile vector = new VectorFile(file);
      check(vector);
      left.remove(vector.message() + (vector.fields == null ? " invalid" : " valid"));
    }
    left.keySet().forEach(name -> failures.add("no vector: " + name));
    if (files.size() < 700) failures.add("only " + files.size() + " vectors");
    writersRefuse();
    failures.forEach(System.err::println);
    System.out.println(parsers.size() + " structures, " + valid + " valid vectors read and written"
        + " again, " + invalid + " invalid ones refused, " + failures.size() + " failures");
    return failures.isEmpty() ? 0 : 1;
  }

  private void check(VectorFile vector) throws IOException {
    final WireParser<?> parser = parsers.get(vector.message());
    if (parser == null) {
      failures.add(vector.name + ": no class for " + vector.message());
      return;
    }
    final byte[] bytes = vector.bytes();
    // Elsewhere than at the start of its buffer, so that offsets are those of the structure.
    final ByteBuffer buffer = ByteBuffer.allocate(bytes.length + 5).put(3, bytes);
    buffer.position(3).limit(3 + bytes.length);
    try {
      final WireView view = parser.parse(buffer);
      if (vector.fields == null) {
        failures.add(vector.name + ": accepted");
        return;
      }
      ++valid;
      good(vector, view, bytes);
    } catch (WireException e) {
      ++invalid;
      final String found = e.fault().name().toLowerCase(Locale.ROOT) + " " + e.offsetBytes() + " "
          + e.requirement();
      final String expected = vector.fault("kind") + " " + vector.fault("offset") + " "
          + vector.fault("requirement");
      expect(vector.name, expected, found);
    }
  }

  private void good(VectorFile vector, WireView view, byte[] bytes) throws WireException {
    final int size = Integer.parseInt(vector.keys.get("size"));
    expect(vector.name, size, view.sizeBytes());
    expect(vector.name, bytes.length, view.bytes().remaining() + view.stale().remaining());
    final Map<String, String> found = new TreeMap<>();
    view.fields((name, value) -> dump(name, value, found));
    expect(vector.name, vector.fields, found);
    final ByteBuffer again = view.toWriter().toBytes();
    expect(vector.name, ByteBuffer.wrap(bytes, 0, size), again);
    expect(vector.name, view.bytes(), again);
  }

  private static void dump(String name, Object value, Map<String, String> out) {
    if (value instanceof WireView) {
      ((WireView) value).fields((inner, v) -> dump(name + "." + inner, v, out));
    } else if (value instanceof List) {
      final List<?> list = (List<?>) value;
      for (int i = 0; i < list.size(); ++i) dump(name + "." + i, list.get(i), out);
    } else {
      out.put(name, text(value));
    }
  }

  private static String text(Object value) {
    if (value instanceof Float) return bits((Float) value);
    if (value instanceof ByteBuffer) {
      final StringBuilder hex = new StringBuilder("x");
      for (final byte b : Wire.copy((ByteBuffer) value)) hex.append(String.format("%02x", b));
      return hex.toString();
    }
    final List<String> items = new ArrayList<>();
    if (value instanceof int[]) {
      for (final int one : (int[]) value) items.add(Integer.toString(one));
    } else if (value instanceof float[]) {
      for (final float one : (float[]) value) items.add(bits(one));
    } else {
      return value.toString();
    }
    return "[" + String.join(" ", items) + "]";
  }

  private static String bits(float value) {
    return Long.toString(Float.floatToRawIntBits(value) & 0xffffffffL);
  }

  /** Tests values that have no bytes, which no vector can show. */
  private void writersRefuse() {
    refused("payload too long", "out_of_range at byte 11: WIRE-NET-NBYTES",
        new NetMsg.Writer().payload(new byte[103]));
    refused("payload too short", "out_of_range at byte 11: WIRE-NET-NBYTES",
        new NetMsg.Writer().payload(new byte[1]));
    refused("a length that would wrap round", "out_of_range at byte 11: WIRE-NET-NBYTES",
        new NetMsg.Writer().payload(new byte[256 + 10]));
    refused("reliable 2", "out_of_range at byte 8: WIRE-NET-RELIABLE",
        new NetMsg.Writer().reliable(2).payload(new byte[2]));
    refused("more floats than there may be", "out_of_range at byte 100: WIRE-SYNAPTIC-DATA",
        new SynapticData.Writer().values(new float[26]));
    refused("a length elsewhere that promises less", "out_of_range at byte 8: WIRE-AM-HEADER",
        new Rubicon.Writer().payload(new byte[3]));
    refused("a length elsewhere that promises more", "truncated at byte 8: WIRE-AM-LENGTH",
        new Rubicon.Writer().am(new rubric.wire.tinyos.AmHeader.Writer().length(1)));
    try {
      new RAddr.Writer().pid(65536);
      failures.add("pid 65536: accepted");
    } catch (IllegalArgumentException e) {
      expect("pid 65536", "65536 is not from 0 to 65535", e.getMessage());
    }
    final ByteBuffer small = ByteBuffer.allocate(3);
    try {
      new RAddr.Writer().writeTo(small);
      failures.add("no room: accepted");
    } catch (java.nio.BufferOverflowException | WireException e) {
      expect("no room", 0, small.position());
    }
  }

  private void refused(String what, String expected, WireWriter writer) {
    try {
      writer.toBytes();
      failures.add(what + ": written");
    } catch (WireException e) {
      expect(what, expected, e.getMessage());
    }
  }

  private void expect(String what, Object expected, Object found) {
    if (expected.equals(found)) return;
    failures.add(what + ": " + text(found) + ", not " + text(expected));
  }
}
