package rubric.wire;

import java.io.IOException;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;

/** A case of spec/vectors; the form is described in its README. */
final class VectorFile {
  final String name;
  final Map<String, String> keys = new TreeMap<>();
  /** Path to value: decimal numbers, "[1 2]" for lists, "x0a" for bytes. Null if invalid. */
  Map<String, String> fields;

  private final List<String> lines = new ArrayList<>();
  private int next = 0;

  VectorFile(Path file) throws IOException {
    name = file.toString();
    for (final String line : Files.readAllLines(file)) {
      if (!line.startsWith("#") && !line.isBlank()) lines.add(line);
    }
    while (next < lines.size()) {
      final String key = keyOf(lines.get(next), 0);
      final String text = valueOf(lines.get(next));
      ++next;
      if (key.equals("fields")) {
        fields = readFields();
      } else {
        keys.put(key, scalar(text, 0));
      }
    }
    if (bytes() == null || message() == null || (fields == null) == (keys.get("fault") == null)) {
      throw new IOException(name + ": not a vector");
    }
  }

  String message() {
    return keys.get("message");
  }

  byte[] bytes() {
    return unhex(keys.get("bytes"));
  }

  /** A member of `fault: {kind: ..., offset: ..., requirement: ...}`. */
  String fault(String member) throws IOException {
    final String text = keys.get("fault");
    if (text == null) return null;
    for (final String part : text.substring(1, text.length() - 1).split(",")) {
      final String one = part.strip();
      if (one.startsWith(member + ": ")) return one.substring(member.length() + 2);
    }
    throw new IOException(name + ": the fault has no " + member);
  }

  private Map<String, String> readFields() throws IOException {
    final Map<String, String> out = new TreeMap<>();
    while (next < lines.size() && lines.get(next).startsWith("  ")) {
      final String line = lines.get(next);
      final String key = keyOf(line, 2);
      ++next;
      final boolean isBytes = valueOf(line).startsWith("\"") || valueOf(line).equals(">-");
      final String value = scalar(valueOf(line), 2);
      out.put(key, isBytes ? "x" + value.replace(" ", "") : value.startsWith("[") ? list(value)
          : number(value));
    }
    return out;
  }

  private String keyOf(String line, int indent) throws IOException {
    final int end = line.indexOf(':');
    final String key = end < 0 ? "" : line.substring(indent, end);
    if (!key.matches("[a-z0-9_.]+")) throw new IOException(name + ": what is this? " + line);
    return key;
  }

  private static String valueOf(String line) {
    return line.substring(line.indexOf(':') + 1).strip();
  }

  /** A quoted or plain text; a folded one, or a list, goes on in lines that are indented more. */
  private String scalar(String first, int indent) throws IOException {
    final StringBuilder out = new StringBuilder(first.equals(">-") ? "" : first);
    while (next < lines.size() && lines.get(next).startsWith(" ".repeat(indent + 1))) {
      out.append(out.length() == 0 ? "" : " ").append(lines.get(next).strip());
      ++next;
    }
    final String text = out.toString();
    if (!text.startsWith("\"")) return text;
    if (text.length() < 2 || !text.endsWith("\"")) throw new IOException(name + ": " + text);
    return text.substring(1, text.length() - 1);
  }

  private static String list(String text) {
    final StringBuilder out = new StringBuilder();
    for (final String item : text.substring(1, text.length() - 1).split(",")) {
      if (item.isBlank()) continue;
      out.append(out.length() == 0 ? "" : " ").append(number(item.strip()));
    }
    return "[" + out + "]";
  }

  private static String number(String text) {
    return Long.decode(text).toString();
  }

  static byte[] unhex(String text) {
    if (text == null) return null;
    final String digits = text.replace(" ", "");
    final byte[] out = new byte[digits.length() / 2];
    for (int i = 0; i < out.length; ++i) {
      out[i] = (byte) Integer.parseInt(digits.substring(2 * i, 2 * i + 2), 16);
    }
    return out;
  }
}
