package rubric.basestation;

import java.io.IOException;
import java.io.PrintStream;
import java.util.concurrent.LinkedBlockingQueue;
import java.util.concurrent.TimeUnit;

/**
 * The base station in real time, with its sink behind a serial forwarder, and its application and
 * PEIS behind rct/1 on standard input and output: `rubric test --target sf-server:PORT:restart
 * --app` runs it. It connects at each reset, with a station that has just started.
 */
public final class LiveAdapter extends RctAdapter {
  private static final String USAGE = "usage: LiveAdapter HOST:PORT\n";
  private static final long LISTENS_MS = 5000; // The forwarder may be about to.
  private static final long NAP_MS = 20;
  private static final long TICKS_PER_SECOND = 1024;

  private final String host;
  private final int port;
  private final LinkedBlockingQueue<Action> news = new LinkedBlockingQueue<>();
  private SerialForwarder forwarder;
  private ForwarderClient client;

  private LiveAdapter(PrintStream out, String host, int port) {
    super(out);
    this.host = host;
    this.port = port;
  }

  /** Exit code: 0 at the end, 2 wrong usage. */
  public static void main(String[] args) throws IOException {
    final int colon = args.length == 1 ? args[0].lastIndexOf(':') : -1;
    if (colon < 0 || !args[0].substring(colon + 1).matches("[0-9]{1,5}")) {
      System.err.print(USAGE);
      System.exit(2);
    }
    final int port = Integer.parseInt(args[0].substring(colon + 1));
    new LiveAdapter(standardOutput(), args[0].substring(0, colon), port).run();
    System.exit(0); // Though a station is still there.
  }

  @Override
  String kind() {
    return "time=real links=app,peis";
  }

  @Override
  void start(int island, BaseStation station) {
    try {
      if (forwarder != null) forwarder.close();
      forwarder = connect();
    } catch (IOException | InterruptedException e) {
      throw new IllegalArgumentException(e.getMessage());
    }
    news.clear();
    final ForwarderClient started = new ForwarderClient(forwarder, station, news::add);
    client = started;
    final Thread thread = new Thread(() -> {
      try {
        started.run(island);
      } catch (IOException e) { // The other end sees that it is gone.
        System.err.println("LiveAdapter: " + e.getMessage());
      } catch (InterruptedException e) {
        Thread.currentThread().interrupt();
      }
    }, "station");
    thread.setDaemon(true);
    thread.start();
  }

  private SerialForwarder connect() throws IOException, InterruptedException {
    final long end = System.currentTimeMillis() + LISTENS_MS;
    while (true) {
      try {
        return new SerialForwarder(host, port);
      } catch (IOException e) {
        if (System.currentTimeMillis() > end) throw e;
        Thread.sleep(NAP_MS);
      }
    }
  }

  /** Times are those at which something is said. */
  @Override
  String at(String[] words) {
    Action one = null;
    if (words[0].equals("until")) {
      one = await(Long.parseLong(words[1]));
    } else {
      final String rest = words.length > 2 ? words[2] : "";
      client.happen((station, now) -> event(station, words[0], rest, now));
    }
    final long now = client.now();
    if (one == null) one = news.poll();
    for (; one != null; one = news.poll()) write(one, now);
    return "done " + now;
  }

  /** The first news until that tick, or null. */
  private Action await(long tick) {
    Action first = news.poll();
    try {
      while (first == null && client.now() < tick) {
        final long ms = (tick - client.now()) * 1000 / TICKS_PER_SECOND + 1;
        first = news.poll(ms, TimeUnit.MILLISECONDS);
      }
    } catch (InterruptedException e) {
      Thread.currentThread().interrupt();
    }
    return first;
  }
}
