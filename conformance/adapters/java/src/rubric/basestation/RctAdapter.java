package rubric.basestation;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.io.PrintStream;
import java.nio.charset.StandardCharsets;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.OptionalLong;
import rubric.wire.WireException;

/**
 * The base station behind rct/1 on standard input and output, in virtual time. The protocol is
 * described in conformance/PORTING.md.
 */
public class RctAdapter {
  private static final String HELLO =
      "hello rct/1 java_base_station 1.0 roles=base_station ";

  private static final List<String> SETTINGS =
      List.of("id", "island", "channels", "seed", "profile");

  protected final PrintStream out;
  private boolean started = false;
  private BaseStation station;
  private long now = 0;

  RctAdapter(PrintStream out) {
    this.out = out;
  }

  public static void main(String[] args) throws IOException {
    new RctAdapter(standardOutput()).run();
  }

  static PrintStream standardOutput() {
    return new PrintStream(System.out, false, StandardCharsets.ISO_8859_1);
  }

  /** Until `bye` or the end of standard input. */
  void run() throws IOException {
    final BufferedReader in =
        new BufferedReader(new InputStreamReader(System.in, StandardCharsets.ISO_8859_1));
    for (String line = in.readLine(); line != null && !line.equals("bye"); line = in.readLine()) {
      answer(line);
      out.flush();
    }
  }

  /** Words of the answer to hello. */
  String kind() {
    return "time=virtual";
  }

  /** Writes what follows from a command, and the closing line. */
  void answer(String line) {
    String closing;
    try {
      closing = handle(line.split(" ", 3));
    } catch (IllegalArgumentException e) {
      closing = "unsupported " + String.valueOf(e.getMessage()).replaceAll("[^ -~]", "?");
    }
    out.print(closing + "\n");
  }

  private String handle(String[] words) {
    switch (words[0]) {
      case "hello":
        if (words.length < 2 || !words[1].matches("rct/[1-9][0-9]*")) break;
        return HELLO + kind();
      case "reset":
        return reset(words);
      case "rx":
      case "call":
      case "linkack":
      case "line":
      case "power":
      case "until":
        if (!started) throw new IllegalArgumentException("reset comes first");
        return at(words);
      default:
        break;
    }
    throw new IllegalArgumentException("unknown command " + words[0]);
  }

  private String reset(String[] words) {
    final String role = words.length > 1 ? words[1] : "";
    if (!role.equals("base_station")) throw new IllegalArgumentException("role " + role);
    final Map<String, String> options = new HashMap<>();
    for (final String word : (words.length > 2 ? words[2] : "").split(" ")) {
      final int equals = word.indexOf('=');
      if (equals > 0) options.put(word.substring(0, equals), word.substring(equals + 1));
    }
    for (final String name : options.keySet()) {
      if (!SETTINGS.contains(name)) throw new IllegalArgumentException("parameter " + name);
    }
    final int island = Integer.parseInt(options.getOrDefault("island", "0"));
    if (island < 0 || island > 65535) throw new IllegalArgumentException("island " + island);
    final long seed = Long.parseUnsignedLong(options.getOrDefault("seed", "0"));
    start(island, new BaseStation(island, (int) (1000 + 257 * (seed & 0xffff))));
    started = true;
    return "ready";
  }

  /** A station that has just started takes the place of the one before. */
  void start(int island, BaseStation station) {
    this.station = station;
    now = 0;
  }

  /** A command with a time. */
  String at(String[] words) {
    final long time = Long.parseLong(words.length > 1 ? words[1] : "");
    if (time < now) throw new IllegalArgumentException("time goes back to " + time);
    if (words[0].equals("until")) return until(time);
    // Earlier timeouts come first.
    for (long due = due(); due < time; due = due()) {
      now = due;
      write(station.timeout(now));
    }
    now = time;
    write(event(station, words[0], words.length > 2 ? words[2] : "", now));
    return next();
  }

  private String until(long time) {
    for (long due = due(); due <= time; due = due()) {
      now = due;
      if (write(station.timeout(now))) return next();
    }
    now = time;
    return next();
  }

  /** What a command makes happen. */
  static List<Action> event(BaseStation station, String command, String rest, long now) {
    final String[] words = rest.split(" ");
    switch (command) {
      case "rx":
        if (words.length != 2) break;
        return hear(station, link(words[0]), Hex.parse(words[1]), now);
      case "call":
        return new Call(rest).on(station, now);
      case "linkack":
        return List.of(); // A base station asks for none.
      case "line":
        if (words.length != 2 || !words[1].matches("busy|idle")) break;
        return line(station, words[0], words[1].equals("busy"), now);
      case "power":
        if (!rest.matches("off|reboot")) break;
        return rest.equals("reboot") ? station.reboot(now) : station.powerOff(now);
      default:
        break;
    }
    throw new IllegalArgumentException("not an argument of " + command + ": " + rest);
  }

  private static List<Action> hear(BaseStation station, Link link, byte[] packet, long now) {
    try {
      return station.hear(Frame.parse(link, packet), now);
    } catch (WireException e) { // No active message: nobody listens.
      return List.of();
    }
  }

  private static List<Action> line(BaseStation station, String name, boolean busy, long now) {
    if (name.equals("app")) return station.appBusy(busy, now);
    // PEIS is a network of PCs, and the radio is not the station's.
    return link(name) == Link.SERIAL ? station.serialTaken(busy, now) : List.of();
  }

  private static Link link(String name) {
    for (final Link link : Link.values()) {
      if (link.toString().equals(name)) return link;
    }
    throw new IllegalArgumentException("unknown line " + name);
  }

  private long due() {
    final OptionalLong due = station.due();
    return due.isPresent() ? Math.max(due.getAsLong(), now) : Long.MAX_VALUE;
  }

  private boolean write(List<Action> actions) {
    for (final Action action : actions) write(action, now);
    return !actions.isEmpty();
  }

  void write(Action action, long time) {
    final String rule = action.rule().isEmpty() ? "\n" : " [" + action.rule() + "]\n";
    if (action instanceof Action.Transmit) {
      final Frame frame = ((Action.Transmit) action).frame();
      out.print("tx " + time + " " + frame.link() + " " + Hex.of(frame.toPacket()) + rule);
    } else {
      out.print("up " + time + " " + action + rule);
    }
  }

  private String next() {
    final OptionalLong due = station.due();
    out.print("next " + (due.isPresent() ? Long.toString(due.getAsLong()) : "-") + "\n");
    return "done " + now;
  }
}
