import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.nio.charset.StandardCharsets;
import java.util.HashMap;
import java.util.HexFormat;
import java.util.Map;
import java.util.OptionalLong;
import java.util.Set;

/**
 * rct/1 around MyNode: reads commands, drives the node, writes what happens.
 *
 *   javac *.java
 *   rubric test --target 'java -cp . Adapter'
 */
final class Adapter implements World {
    // TODO: what you play: "mote", "sink" or "base_station".
    private static final String ROLE = "mote";
    private static final Set<String> COMMANDS =
            Set.of("rx", "call", "linkack", "line", "power", "until");

    /** A feature that this implementation lacks: the case is skipped, and the report shows it. */
    private static final class Unsupported extends RuntimeException {
        private static final long serialVersionUID = 1;

        Unsupported(String why) {
            super(why);
        }
    }

    private final StringBuilder out = new StringBuilder();
    private String role = "";
    private Map<String, String> settings = Map.of();
    private MyNode node; // null while the power is off.
    private int number;
    private long now;
    private boolean wrote;

    @Override
    public void tx(String line, byte[] packet, boolean linkAck) {
        String hex = HexFormat.of().formatHex(packet);
        write("tx " + now + " " + line + " " + hex + (linkAck ? " linkack" : ""));
    }

    @Override
    public void up(String news) {
        write("up " + now + " " + news);
    }

    private void write(String line) {
        out.append(line).append('\n');
        wrote = true;
    }

    /** All lines of the answer. */
    String answer(String line) {
        out.setLength(0);
        try {
            out.append(closing(line));
        } catch (Unsupported why) {
            out.append("unsupported ").append(why.getMessage());
        }
        return out.append('\n').toString();
    }

    private String closing(String line) {
        String[] words = line.split(" ", 4);
        if (words[0].equals("hello")) {
            // TODO: the name and version of your implementation.
            return "hello rct/1 my_node 0.1 roles=" + ROLE + " time=virtual";
        }
        if (words[0].equals("reset")) {
            return reset(line);
        }
        if (role.isEmpty() || !COMMANDS.contains(words[0])) {
            throw new Unsupported("command " + words[0]);
        }
        wrote = false;
        pass(Long.parseLong(words[1]), words[0].equals("until"));
        if (node != null || words[0].equals("power")) {
            work(words, line);
        }
        OptionalLong due = node == null ? OptionalLong.empty() : node.due();
        out.append("next ").append(due.isPresent() ? due.getAsLong() : "-").append('\n');
        return "done " + now;
    }

    private String reset(String line) {
        String[] words = line.split(" ", 3);
        if (!words[1].equals(ROLE)) {
            throw new Unsupported("role " + words[1]);
        }
        role = words[1];
        settings = argumentsOf(words[2]);
        for (String name : settings.keySet()) { // TODO: if you can be built with other parameters.
            if (!Set.of("id", "island", "channels", "seed", "profile").contains(name)) {
                throw new Unsupported(name);
            }
        }
        number = (int) ((1000 + 257 * Long.parseLong(settings.get("seed"))) & 0xFFFF);
        now = 0;
        start();
        return "ready";
    }

    private void start() {
        node = new MyNode(this, role, settings, number, now);
    }

    /** Lets time pass, but no further than the first instant at which the node writes something. */
    private void pass(long until, boolean stopAtOutput) {
        while (node != null && !(stopAtOutput && wrote)) {
            OptionalLong due = node.due();
            if (due.isEmpty() || due.getAsLong() > until) {
                break;
            }
            now = Math.max(now, due.getAsLong());
            node.setTime(now);
            node.runDue();
        }
        if (stopAtOutput && wrote) {
            return;
        }
        now = until;
        if (node != null) {
            node.setTime(now);
        }
    }

    private void work(String[] words, String line) {
        switch (words[0]) {
            case "rx" -> node.heard(words[2], HexFormat.of().parseHex(words[3]));
            case "line" -> node.setBusy(words[2], words[3].equals("busy"));
            case "linkack" -> node.confirmed(words[2].equals("1"));
            case "call" -> call(line.split(" ", 3)[2]);
            case "power" -> power(words[2]);
            default -> { } // until: time has passed.
        }
    }

    private void call(String text) {
        int open = text.indexOf('(');
        String name = text.substring(0, open);
        if (!node.call(name, argumentsOf(text.substring(open + 1, text.length() - 1)))) {
            throw new Unsupported("call " + name);
        }
    }

    private void power(String what) {
        if (node != null) {
            number = node.nextNumber();
        }
        node = null;
        if (what.equals("reboot")) {
            start();
        }
    }

    private static Map<String, String> argumentsOf(String text) {
        Map<String, String> arguments = new HashMap<>();
        for (String word : text.split(" ")) {
            int equals = word.indexOf('=');
            if (equals >= 0) {
                arguments.put(word.substring(0, equals), word.substring(equals + 1));
            }
        }
        return arguments;
    }

    public static void main(String[] arguments) throws IOException {
        Adapter adapter = new Adapter();
        BufferedReader in =
                new BufferedReader(new InputStreamReader(System.in, StandardCharsets.US_ASCII));
        for (String line; (line = in.readLine()) != null && !line.equals("bye"); ) {
            System.out.print(adapter.answer(line));
            System.out.flush();
        }
    }
}
