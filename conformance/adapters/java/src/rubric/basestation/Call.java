package rubric.basestation;

import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;

/**
 * A call of the application as text: "send(dest=11:5 app_id=5 reliable=1 data=x01)". Numbers are
 * decimal or 0x.
 */
final class Call {
  private final String name;
  private final Map<String, String> arguments = new LinkedHashMap<>();

  /** Throws IllegalArgumentException if the text is no call. */
  Call(String text) {
    final int open = text.indexOf('(');
    if (open <= 0 || !text.endsWith(")")) {
      throw new IllegalArgumentException("not NAME(ARGUMENTS): " + text);
    }
    name = text.substring(0, open);
    for (final String one : text.substring(open + 1, text.length() - 1).split(" ")) {
      if (one.isEmpty()) continue;
      final int equals = one.indexOf('=');
      if (equals <= 0) throw new IllegalArgumentException("not NAME=VALUE: " + one);
      arguments.put(one.substring(0, equals), one.substring(equals + 1));
    }
  }

  /** Calls the station; throws IllegalArgumentException where it has no such call. */
  List<Action> on(BaseStation station, long now) {
    switch (name) {
      case "send":
        return station.send(address("dest"), number("app_id", 255), number("reliable", 1) == 1,
            bytes("data"), now);
      case "set_island_id":
        return station.setIslandId(number("island", 65535), now);
      case "interface":
        return station.setInterface(link(), number("on", 1) == 1, now);
      case "get_interface":
        return station.getInterface(link(), now);
      case "get_clock":
        return station.getClock(now);
      case "join":
        return station.join(now);
      case "create_out", "create_in":
        return station.refuseChannels("channel_result(0->0 fail)", now);
      case "read_input":
        return station.refuseChannels("input_value(0 fail)", now);
      case "dispose", "start", "stop", "start_all", "stop_all", "write_output", "set_time_step":
        return station.refuseChannels("op_result(fail)", now);
      default:
        throw new IllegalArgumentException("a base station has no call " + name);
    }
  }

  private String argument(String key) {
    final String value = arguments.get(key);
    if (value == null) throw new IllegalArgumentException(name + " needs " + key);
    return value;
  }

  private int number(String key, int max) {
    return within(argument(key), max);
  }

  private Address address(String key) {
    final String[] parts = argument(key).split(":", -1);
    if (parts.length != 2) throw new IllegalArgumentException("not ISLAND:DEVICE: " + key);
    return new Address(within(parts[0], 65535), within(parts[1], 65535));
  }

  private byte[] bytes(String key) {
    final String text = argument(key);
    if (!text.startsWith("x")) throw new IllegalArgumentException("not xHEX: " + text);
    return Hex.parse(text.substring(1));
  }

  private Link link() {
    return Link.values()[number("link", Link.values().length - 1)];
  }

  private static int within(String text, int max) {
    final long value = Long.decode(text);
    if (value < 0 || value > max) throw new IllegalArgumentException(text + " is over " + max);
    return (int) value;
  }
}
