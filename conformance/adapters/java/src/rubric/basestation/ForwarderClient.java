package rubric.basestation;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.nio.charset.StandardCharsets;
import java.util.List;
import java.util.OptionalLong;
import java.util.concurrent.BlockingQueue;
import java.util.concurrent.CompletableFuture;
import java.util.concurrent.ExecutionException;
import java.util.concurrent.LinkedBlockingQueue;
import java.util.concurrent.ThreadLocalRandom;
import java.util.concurrent.TimeUnit;
import java.util.concurrent.TimeoutException;
import java.util.function.BiFunction;
import java.util.function.Consumer;
import rubric.wire.WireException;

/**
 * The base station of a real island: its sink is behind a serial forwarder, time is real.
 *
 * <p>It sends its sink the island first. News for the application are lines on standard output,
 * such as {@code received(11:5 5 x0102)}; calls are lines on standard input, such as
 * {@code send(dest=11:5 app_id=5 reliable=1 data=x0102)}. Messages for other islands are said to go
 * nowhere: this program has no PEIS network.
 */
public final class ForwarderClient {
  private static final String USAGE = "usage: ForwarderClient HOST:PORT ISLAND\n";
  private static final long HAPPEN_MS = 2000;
  private static final long TICKS_PER_SECOND = 1024;
  private static final long NANOS_PER_SECOND = 1_000_000_000;

  /** Events in their order; one thread handles them. */
  private interface Event {
    /** Returns what follows, or null where the connection has ended; throws where it broke. */
    List<Action> happen(long now) throws IOException;
  }

  private final BlockingQueue<Event> events = new LinkedBlockingQueue<>();
  private final SerialForwarder forwarder;
  private final BaseStation station;
  private final Consumer<Action> others;
  private final long start = System.nanoTime();

  /** What does not go to the serial line goes to `others`. */
  ForwarderClient(SerialForwarder forwarder, BaseStation station, Consumer<Action> others) {
    this.forwarder = forwarder;
    this.station = station;
    this.others = others;
  }

  /** Exit code: 0 the forwarder closed the connection, 1 it could not be used, 2 wrong usage. */
  public static void main(String[] args) throws InterruptedException {
    final int colon = args.length == 2 ? args[0].lastIndexOf(':') : -1;
    final int port = colon < 0 ? 0 : number(args[0].substring(colon + 1), 65535);
    final int island = args.length == 2 ? number(args[1], 65535) : 0;
    if (port <= 0 || island < 0 || Address.isReserved(island)) {
      System.err.print(USAGE);
      System.exit(2);
    }
    try (SerialForwarder forwarder = new SerialForwarder(args[0].substring(0, colon), port)) {
      // Numbers of an earlier run may still be awaited somewhere.
      final int firstSeqNum = ThreadLocalRandom.current().nextInt(0x10000);
      final ForwarderClient client = new ForwarderClient(
          forwarder, new BaseStation(island, firstSeqNum), ForwarderClient::print);
      listen("calls", client::readCalls);
      client.run(island);
      System.exit(0); // Though somebody still waits for a line of standard input.
    } catch (IOException e) {
      System.err.println("ForwarderClient: " + args[0] + ": " + e.getMessage());
      System.exit(1);
    }
  }

  private static int number(String text, int max) {
    try {
      final int value = Integer.decode(text);
      return value <= max ? value : -1;
    } catch (NumberFormatException e) {
      return -1;
    }
  }

  /** Until the connection ends. */
  void run(int island) throws IOException, InterruptedException {
    perform(station.setIslandId(island, now()));
    listen("serial", this::readPackets);
    while (true) {
      final Event event = next();
      final long now = now();
      // Timeouts due before the event come first, in order.
      perform(station.timeout(now));
      if (event == null) continue;
      final List<Action> actions = event.happen(now);
      if (actions == null) return;
      perform(actions);
    }
  }

  /** The next event, or null where a timeout comes first. */
  private Event next() throws InterruptedException {
    final OptionalLong due = station.due();
    if (due.isEmpty()) return events.take();
    // Not a tick too early.
    final long nanos = start - System.nanoTime()
        + (due.getAsLong() * NANOS_PER_SECOND + TICKS_PER_SECOND - 1) / TICKS_PER_SECOND;
    return events.poll(Math.max(0, nanos), TimeUnit.NANOSECONDS);
  }

  long now() {
    final long nanos = System.nanoTime() - start;
    return nanos / NANOS_PER_SECOND * TICKS_PER_SECOND
        + nanos % NANOS_PER_SECOND * TICKS_PER_SECOND / NANOS_PER_SECOND;
  }

  private void perform(List<Action> actions) throws IOException {
    for (final Action action : actions) {
      if (action instanceof Action.Transmit
          && ((Action.Transmit) action).frame().link() == Link.SERIAL) {
        forwarder.write(((Action.Transmit) action).frame().toPacket());
      } else {
        others.accept(action);
      }
    }
  }

  private static void print(Action action) {
    if (action instanceof Action.Transmit) {
      final Frame frame = ((Action.Transmit) action).frame();
      System.err.println("ForwarderClient: no way to island " + frame.dest());
    } else {
      System.out.println(action);
    }
  }

  /** Something happens beside the line; returns when what follows has been done. */
  void happen(BiFunction<BaseStation, Long, List<Action>> what) {
    final CompletableFuture<Void> done = new CompletableFuture<>();
    events.add(now -> {
      try {
        perform(what.apply(station, now));
        done.complete(null);
      } catch (IllegalArgumentException e) {
        done.completeExceptionally(e);
      }
      return List.of();
    });
    try {
      done.get(HAPPEN_MS, TimeUnit.MILLISECONDS);
    } catch (InterruptedException | ExecutionException | TimeoutException e) {
      final String why = e.getCause() == null ? "the line has ended" : e.getCause().getMessage();
      throw new IllegalArgumentException(why);
    }
  }

  private void readPackets() {
    try {
      for (byte[] packet = forwarder.read(); packet != null; packet = forwarder.read()) {
        final byte[] one = packet;
        events.add(now -> hear(one, now));
      }
      events.add(now -> null);
    } catch (IOException e) {
      events.add(now -> {
        throw e;
      });
    }
  }

  private List<Action> hear(byte[] packet, long now) {
    try {
      return station.hear(Frame.parse(Link.SERIAL, packet), now);
    } catch (WireException e) {
      System.err.println("ForwarderClient: no active message: " + e.getMessage());
      return List.of();
    }
  }

  private void readCalls() {
    final BufferedReader in =
        new BufferedReader(new InputStreamReader(System.in, StandardCharsets.US_ASCII));
    try {
      for (String line = in.readLine(); line != null; line = in.readLine()) {
        final String call = line;
        events.add(now -> call(call, now));
      }
    } catch (IOException e) {
      System.err.println("ForwarderClient: standard input: " + e.getMessage());
    }
  }

  private List<Action> call(String text, long now) {
    try {
      return new Call(text).on(station, now);
    } catch (IllegalArgumentException e) {
      System.err.println("ForwarderClient: " + e.getMessage());
      return List.of();
    }
  }

  private static void listen(String name, Runnable reader) {
    final Thread thread = new Thread(reader, name);
    thread.setDaemon(true);
    thread.start();
  }
}
