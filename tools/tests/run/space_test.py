#!/usr/bin/env python3
"""The tuple space, as subscribers of a real broker see it, and what comes from others there.

Usage: space_test.py RUBRIC MOSQUITTO. All of it on this host's loopback.
"""

import contextlib
import json
import os
import pwd
import re
import signal
import socket
import ssl
import struct
import subprocess
import sys
import threading
import time
import unittest

import jsonschema

BROKER = sys.argv.pop(2)

from live_testing import LiveTest  # noqa: E402 pylint: disable=wrong-import-position
from run_test import KNOCK, Node  # noqa: E402 pylint: disable=wrong-import-position
# pylint: disable-next=wrong-import-position
from serial_testing import PATIENCE_S, held_port, wait_for  # noqa: E402
from testing import ROOT, rubric  # noqa: E402 pylint: disable=wrong-import-position

SCHEMA = json.loads((ROOT / "spec/space/schema.json").read_text(encoding="utf-8"))
KINDS = {r"rubicon/\d+/availability": "island", r"rubicon/(\d+|all)/net": "net",
         r"rubicon/\d+/events": "events", r"rubicon/\d+/motes/\d+": "mote",
         r"rubicon/\d+/motes/\d+/state": "state", r"rubicon/\d+/motes/\d+/set": "set",
         r"rubicon/\d+/motes/\d+/availability": "availability"}
USER = {"RUBRIC_MQTT_USER": "gate", "RUBRIC_MQTT_PASSWORD": "sesame"}


def wrong_in(topic, payload):
    """What the schema says of a payload; None: nothing."""
    kind = next(kind for pattern, kind in KINDS.items() if re.fullmatch(pattern, topic))
    schema = {"$ref": f"#/$defs/payloads/{kind}", "$defs": SCHEMA["$defs"]}
    try:
        jsonschema.Draft202012Validator(schema).validate(payload)
    except jsonschema.ValidationError as error:
        return f"{topic}: {error.message}"
    return None


class Subscriber:
    """mosquitto_sub, whose messages are held to the schema as they come."""

    def __init__(self, test, broker, topic="rubicon/#"):
        self.test = test
        self.seen = []
        self.process = subprocess.Popen(
            [*broker.client("mosquitto_sub"), "-q", "2", "-t", topic, "-F", "%r %t %p"],
            stdout=subprocess.PIPE, text=True)
        test.addCleanup(self.process.stdout.close)
        test.addCleanup(self.process.wait)
        test.addCleanup(self.process.kill)

    def until(self, wanted, what):
        """The first message, seen already or still to come, for which wanted(topic, payload)."""
        deadline = time.monotonic() + PATIENCE_S
        for retained, topic, payload in self.seen:
            if wanted(topic, payload):
                return retained, topic, payload
        os.set_blocking(self.process.stdout.fileno(), True)
        while time.monotonic() < deadline:
            retained, topic, text = self.process.stdout.readline().rstrip("\n").split(" ", 2)
            if topic.endswith("/set") or not text:
                continue  # Ours, and a tuple taken away.
            payload = json.loads(text)
            self.test.assertIsNone(wrong_in(topic, payload), text)
            self.seen.append((retained == "1", topic, payload))
            if wanted(topic, payload):
                return self.seen[-1]
        raise AssertionError(f"{what} in {self.seen}")

    def event(self, **fields):
        """An event with these fields."""
        return self.until(lambda topic, payload: topic.endswith("/events")
                          and fields.items() <= payload["data"].items(), fields)[2]["data"]

    def state(self, topic, state):
        return self.until(lambda at, payload: at == topic and payload["data"] == {"state": state},
                          (topic, state))


def openssl(*arguments):
    subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True)


def certificates(folder):
    """Makes an authority, ca.crt, and a certificate of this host by it, host.crt and host.key."""
    openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=ours",
            "-keyout", folder / "ca.key", "-out", folder / "ca.crt")
    openssl("req", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost", "-keyout",
            folder / "host.key", "-out", folder / "host.csr")
    (folder / "names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n", encoding="utf-8")
    openssl("x509", "-req", "-in", folder / "host.csr", "-CA", folder / "ca.crt", "-CAkey",
            folder / "ca.key", "-CAcreateserial", "-days", "2", "-extfile", folder / "names",
            "-out", folder / "host.crt")


def slow_host(test):
    """The port of a host with the certificates() of a test, which begins TLS only after a while."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(test.folder / "host.crt", test.folder / "host.key")
    listener = socket.create_server(("127.0.0.1", 0))
    test.addCleanup(listener.close)

    def serve():
        client = listener.accept()[0]
        time.sleep(0.3)
        with contextlib.suppress(OSError):  # The client does not trust it, and goes.
            context.wrap_socket(client, server_side=True).close()
        client.close()
    threading.Thread(target=serve, daemon=True).start()
    return listener.getsockname()[1]


def cutting_host(test):
    """The port of a host that resets each connection in TLS's handshake."""
    listener = socket.create_server(("127.0.0.1", 0))
    test.addCleanup(listener.close)

    def serve():
        with contextlib.suppress(OSError):  # The test is over.
            while True:
                client = listener.accept()[0]
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                client.close()
    threading.Thread(target=serve, daemon=True).start()
    return listener.getsockname()[1]


class Broker:
    """mosquitto, which asks for a user; with `tls` a folder of certificates(); with `asks` for a
    certificate, too."""

    def __init__(self, test, port, tls=None, asks=False):
        self.port = port
        self.tls = tls
        self.asks = asks
        folder = test.folder
        subprocess.run(["mosquitto_passwd", "-b", "-c", folder / "users", *USER.values()],
                       check=True, capture_output=True)
        self.file = folder / "mosquitto.conf"
        self.file.write_text(f"listener {port} 127.0.0.1\nallow_anonymous false\n"
                             f"password_file {folder}/users\n"
                             f"user {pwd.getpwuid(os.getuid()).pw_name}\n" +
                             (f"certfile {tls}/host.crt\nkeyfile {tls}/host.key\n" if tls else "") +
                             (f"cafile {tls}/ca.crt\nrequire_certificate true\n" if asks else ""),
                             encoding="utf-8")
        self.process = None
        test.addCleanup(self.stop)
        self.start()

    def start(self):
        self.process = subprocess.Popen([BROKER, "-c", self.file], stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        wait_for(lambda: not subprocess.run([*self.client("mosquitto_pub"), "-t", "up", "-n"],
                                            capture_output=True, check=False).returncode,
                 "the broker is there")

    def stop(self):
        if self.process:
            self.process.terminate()
            self.process.wait()
        self.process = None

    def kill(self):
        """Ends it without a goodbye."""
        self.process.kill()
        self.stop()

    def client(self, program):
        user, password = USER.values()
        secure = ["--cafile", self.tls / "ca.crt"] if self.tls else []
        if self.asks:
            secure += ["--cert", self.tls / "host.crt", "--key", self.tls / "host.key"]
        return [program, "-h", "127.0.0.1", "-p", str(self.port), "-u", user, "-P", password,
                *secure]

    def publish(self, topic, payload, *more):
        subprocess.run([*self.client("mosquitto_pub"), "-q", "1", "-t", topic, "-m", payload,
                        *more], check=True)

    @property
    def url(self):
        return f"mqtt{'s' if self.tls else ''}://127.0.0.1:{self.port}/rubicon"


class Space(LiveTest):
    program = Node

    def setUp(self):
        super().setUp()
        port = held_port()
        self.broker = Broker(self, port.__enter__())
        self.sink = None  # Of the island that was begun last.
        self.addCleanup(port.__exit__, None, None, None)

    def island(self, number, *more, **environment):
        sink = self.started("sink", "--island", number, "--radio", "zep:0", "--serial",
                            "sf-server:0")
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        serial = "sf@127.0.0.1:" + sink.waits_for(rb"sf-server:(\d+)\n")
        base = self.started("base-station", "--island", number, "--sink", serial, "--space",
                            self.broker.url, *more, env={**os.environ, **USER, **environment})
        base.waits_for(rb"(mqtts?://\S+: connected)")
        sink.waits_for(rb"(sf-server:\d+: connected)")
        self.sink = sink
        return base, air

    def mote(self, number, air, **more):
        mote = self.started("mote", "--id", number, "--radio", air, "--app", "demo",
                            "--transducers", "light,temp", **more)
        mote.event("joined", success=True)
        return mote

    def test_an_island_is_published(self):
        subscriber = Subscriber(self, self.broker)
        base, air = self.island(11, "--gone-after", "2")
        subscriber.state("rubicon/11/availability", "online")
        mote = self.mote(5, air)
        described = subscriber.until(lambda topic, _: topic == "rubicon/11/motes/5", "mote")[2]
        self.assertEqual(described["creator"], "11:null")
        self.assertEqual(described["data"]["type"], "telosb_demo")
        self.assertEqual(described["data"]["transducers"], ["light", "temp"])
        subscriber.state("rubicon/11/motes/5/availability", "online")
        state = subscriber.until(lambda topic, _: topic == "rubicon/11/motes/5/state", "state")[2]
        temp = state["data"]["temp"]
        self.assertEqual(temp["unit"], "degC")
        self.assertAlmostEqual(temp["value"], temp["raw"] * 0.01 - 40)
        # Who comes later sees the tuples, and no events.
        late = Subscriber(self, self.broker)
        retained = late.until(lambda topic, _: topic == "rubicon/11/motes/5/state", "state")[0]
        self.assertTrue(retained)
        # A wish, and what becomes of it.
        self.broker.publish("rubicon/11/motes/5/set", '{"command":"OPEN_DOOR","id":"w1"}')
        subscriber.event(event="sent", mote=5, id="w1")
        subscriber.event(event="done", mote=5, id="w1")
        mote.event("received", src="11:65533", data=b"OPEN_DOOR".hex())
        self.broker.publish("rubicon/11/motes/5/set",
                            '{"sampling_ms":200,"transducers":["light"],"id":"w2"}')
        subscriber.event(event="done", id="w2")
        subscriber.until(lambda topic, payload: topic.endswith("5/state")
                         and list(payload["data"]) == ["light"], "light alone")
        # The mote has gone, and then the base station, without a word.
        mote.process.kill()
        subscriber.event(event="mote_left", mote="11:5")
        subscriber.state("rubicon/11/motes/5/availability", "offline")
        base.process.kill()
        self.assertEqual(subscriber.state("rubicon/11/availability", "offline")[1],
                         "rubicon/11/availability")

    def test_home_assistant(self):
        found = subprocess.Popen([*self.broker.client("mosquitto_sub"), "-t", "homeassistant/#",
                                  "-C", "2", "-F", "%t %p", "-W", str(PATIENCE_S)],
                                 stdout=subprocess.PIPE, text=True)
        self.addCleanup(found.stdout.close)
        self.addCleanup(found.wait)
        self.addCleanup(found.kill)
        subscriber = Subscriber(self, self.broker)
        _, air = self.island(11, "--home-assistant")
        self.mote(5, air)
        state = subscriber.until(lambda topic, _: topic == "rubicon/11/motes/5/state", "state")[2]
        lines, _ = found.communicate(timeout=PATIENCE_S)
        for line, sensor in zip(lines.splitlines(), ("light", "temp")):
            topic, text = line.split(" ", 1)
            config = json.loads(text)
            self.assertEqual(topic, f"homeassistant/sensor/rubicon_11_5/{sensor}/config")
            self.assertEqual(config["state_topic"], "rubicon/11/motes/5/state")
            at = state
            path = re.fullmatch(r"{{ value_json\.(.*) }}", config["value_template"])[1]
            for word in path.split("."):
                at = at[word]
            self.assertIsInstance(at, (int, float))
            for one in config["availability"]:
                subscriber.state(one["topic"], "online")
        self.assertEqual(config["unit_of_measurement"], "\u00b0C")

    def test_home_assistant_forgets_sensors_that_a_mote_lost(self):
        found = subprocess.Popen([*self.broker.client("mosquitto_sub"), "-t", "homeassistant/#",
                                  "-F", "%t %p"], stdout=subprocess.PIPE, text=True)
        self.addCleanup(found.stdout.close)
        self.addCleanup(found.wait)
        self.addCleanup(found.kill)

        def announced():
            topic, text = found.stdout.readline().rstrip("\n").split(" ", 1)
            return topic.split("/")[3], bool(text)

        both = {("light", True), ("temp", True)}
        base, air = self.island(11, "--home-assistant")
        mote = self.mote(5, air)
        self.assertEqual({announced(), announced()}, both)
        for running in (mote, base):
            running.process.kill()
            running.process.wait()
        _, air = self.island(11, "--home-assistant")
        self.assertEqual({announced(), announced()}, both)  # By what its tuple says.
        self.started("mote", "--id", 5, "--radio", air, "--app", "demo", "--transducers", "light")
        self.assertEqual({announced(), announced()}, {("light", True), ("temp", False)})

    def test_foreign_input_is_refused(self):
        subscriber = Subscriber(self, self.broker, "rubicon/11/events")
        base, air = self.island(11)
        self.mote(5, air)
        with self.subTest("wishes"):
            for number, (payload, why) in enumerate((
                    ("{", "no JSON"), ("[]", "expected a JSON object"), ("7", "a JSON object"),
                    ('{"command":""}', "empty"), ('{"command":7}', "expected a text"),
                    ('{"command":"a","colour":1}', "unknown key 'colour'"),
                    ('{"command":"' + "a" * 101 + '"}', "over 100 bytes"),
                    ('{"data":"0"}', "in hex"), ('{"data":"00","app_id":256}', "from 0 to 255"),
                    ('{"sampling_ms":1,"transducers":["lite"]}', "'lite' is none of"),
                    ('{"sampling_ms":1,"transducers":["humid"]}', "the mote has no humid"),
                    ('{"sampling_ms":1}', "transducers is missing"),
                    ('{"sampling_ms":70000,"transducers":[]}', "from 0 to 65535"),
                    ('{"creator":"me","time":"now","data":{}}', "expected a time"),
                    ('{"x":"' + "a" * 5000 + '"}', "over 4096 bytes"))):
                time.sleep(1.05 if number == 0 else 0)
                self.broker.publish("rubicon/11/motes/5/set", payload)
                if not why.startswith(("no JSON", "expected a JSON", "a JSON", "over 4096",
                                       "expected a time")):
                    event = subscriber.event(event="refused", mote=5)
                    self.assertIn(why, event["why"])
                    subscriber.seen.clear()
        self.broker.publish("rubicon/11/motes/9/set", '{"command":"a"}')
        self.assertIn("has not joined", subscriber.event(event="refused", mote=9)["why"])
        self.broker.publish("rubicon/11/motes/5/set", '{"command":"a","id":"old"}')
        subscriber.event(event="done", id="old")
        for payload in ('{"src":12,"dest":11,"net_msg":"00"}', '{"src":12,"dest":13,"net_msg":""}',
                        '{"src":65533,"dest":11,"net_msg":""}'):
            self.broker.publish("rubicon/11/net", payload)
        self.broker.publish("rubicon/11/motes/5/set", '{"command":"b","id":"still here"}')
        subscriber.event(event="done", id="still here")
        code, _, err = base.end()
        self.assertEqual(code, 0)
        self.assertIn("rubric: space: refused 11/motes/5/set: no JSON of this layout", err)
        self.assertRegex(err, r"space: refused \d+ more")

    def test_a_burst_of_wishes_is_not_lost(self):
        """A sink's radio sends fewer messages in a second than come at once. One that this host
        holds up for a while drops a few, and says how many."""
        subscriber = Subscriber(self, self.broker, "rubicon/11/events")
        _, air = self.island(11)
        mote = self.mote(5, air)
        count = 300
        wishes = "".join(f'{{"data":"{number:04x}","reliable":false,"id":"{number}"}}\n'
                         for number in range(count))
        subprocess.run([*self.broker.client("mosquitto_pub"), "-q", "1", "-t",
                        "rubicon/11/motes/5/set", "-l"], input=wishes.encode(), check=True)
        subscriber.event(event="sent", id=str(count - 1))
        self.broker.publish("rubicon/11/motes/5/set", '{"data":"ff","id":"last"}')
        subscriber.event(event="done", id="last")
        came = 0
        while mote.event("received")["data"] != "ff":
            came += 1
        said = self.sink.end()[2]
        drops = re.findall(r"(\d+) messages from the serial line were dropped", said)
        dropped = sum(map(int, drops))
        self.assertEqual(came + dropped, count, said)
        self.assertGreater(came, 200)

    def test_wishes_wait_while_a_mote_does_not_answer(self):
        """A base station awaits eight acknowledgements at once."""
        subscriber = Subscriber(self, self.broker, "rubicon/11/events")
        _, air = self.island(11)
        silent = self.mote(5, air)
        self.mote(6, air)
        for mote in ("11:5", "11:6"):
            subscriber.event(event="received", src=mote)
        silent.process.kill()
        subprocess.run([*self.broker.client("mosquitto_pub"), "-q", "1", "-t",
                        "rubicon/11/motes/5/set", "-l"],
                       input=12 * b'{"command":"a"}\n', check=True)
        self.broker.publish("rubicon/11/motes/6/set", '{"command":"a","id":"other"}')
        subscriber.event(event="sent", id="other")
        told = [payload["data"]["event"] for _, _, payload in subscriber.seen]
        self.assertEqual((told.count("sent"), told.count("refused")), (13, 0))

    def test_goodbyes_to_a_broker_that_hangs(self):
        """Those of several islands take as long as that of one."""
        def ends(count):
            islands = "".join(f'  - {{island: {11 + one}, radio: "zep:0"}}\n'
                              for one in range(count))
            plan = self.write(f"{count}.yaml", f"islands:\n{islands}")
            run = self.started(plan, "--space", self.broker.url, env={**os.environ, **USER})
            for _ in range(count):
                run.waits_for(rb"(mqtt://\S+: connected)")
            self.broker.process.send_signal(signal.SIGSTOP)
            begun = time.monotonic()
            code, _, err = run.end()
            self.broker.process.send_signal(signal.SIGCONT)
            self.assertEqual(code, 0, err)
            return time.monotonic() - begun

        self.assertLess(ends(4), ends(1) + 2)

    def test_a_wish_that_stays_is_refused(self):
        """It is one like any other for who is there, and is refused at each start."""
        subscriber = Subscriber(self, self.broker, "rubicon/11/events")
        base, air = self.island(11)
        self.mote(5, air)
        self.broker.publish("rubicon/11/motes/5/set", '{"command":"OPEN_DOOR","id":"stays"}', "-r")
        subscriber.event(event="done", id="stays")
        self.assertEqual(base.end()[0], 0)
        base, _ = self.island(11)
        base.waits_for(rb"(refused 11/motes/5/set: a wish that stays)")

    def test_base_stations_meet_there(self):
        (self.folder / "knock.py").write_text(KNOCK, encoding="utf-8")
        door = ROOT / "conformance/node/examples/door.py"
        plan = self.folder / "islands.yaml"
        plan.write_text(f"""
space: {self.broker.url}
islands:
  - {{island: 11, radio: "zep:0", motes: [{{id: 5, app: python3 {door}}}]}}
  - {{island: 12, radio: "zep:0", app: python3 {self.folder / "knock.py"}}}
""", encoding="utf-8")
        subscriber = Subscriber(self, self.broker)
        users = self.write("gate", "# ours\nuser=gate\npassword=sesame\n")
        run = self.started(plan, "--credentials", users, "--log", self.folder / "run.rtr")
        while run.event("received", src="11:5")["data"] != b"DOOR_IS_OPEN".hex():
            pass
        subscriber.until(lambda topic, payload: topic == "rubicon/12/net"
                         and payload["data"]["src"] == 11, "net")
        code, _, err = run.end()
        self.assertEqual(code, 0, err)
        subscriber.state("rubicon/12/availability", "offline")
        self.passes(self.folder / "run.rtr")

    def test_the_broker_goes_and_comes(self):
        self.broker.stop()
        # Of this name's addresses the broker has one.
        url = self.broker.url.replace("127.0.0.1", "localhost")
        early = self.started("base-station", "--island", "12", "--space", url,
                             env={**os.environ, **USER})
        early.waits_for(rb"(mqtt://\S+: Connection refused)")
        self.broker.start()
        early.waits_for(rb"(mqtts?://\S+: connected)")
        base, air = self.island(11)
        self.mote(5, air)
        self.broker.stop()
        base.waits_for(rb"(mqtt://\S+: the connection is lost)")
        self.broker.start()
        base.waits_for(rb"(mqtts?://\S+: connected)")
        subscriber = Subscriber(self, self.broker)
        subscriber.until(lambda topic, _: topic == "rubicon/11/motes/5", "the mote, written anew")
        self.assertEqual(base.end()[0], 0)
        subscriber.state("rubicon/11/availability", "offline")

    def test_a_mote_that_joined_before_takes_wishes(self):
        sink = self.started("sink", "--island", 11, "--radio", "zep:0", "--serial", "sf-server:0")
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        serial = "sf@127.0.0.1:" + sink.waits_for(rb"sf-server:(\d+)\n")
        self.mote(5, air)
        subscriber = Subscriber(self, self.broker)
        self.started("base-station", "--island", 11, "--sink", serial, "--space", self.broker.url,
                     env={**os.environ, **USER})
        state = subscriber.until(lambda topic, _: topic == "rubicon/11/motes/5/state", "state")[2]
        self.assertEqual(set(state["data"]["temp"]), {"raw"}, "nothing is known of its type")
        self.broker.publish("rubicon/11/motes/5/set", '{"command":"a","id":"late"}')
        subscriber.event(event="done", id="late")

    def test_users(self):
        sink = ("base-station", "--island", "11", "--space", self.broker.url)
        base = self.started(*sink, env={**os.environ, "RUBRIC_MQTT_USER": "gate",
                                        "RUBRIC_MQTT_PASSWORD": "simsim"})
        self.assertRegex(base.waits_for(rb"mqtt://\S+: (.*)\n"), "not authori[sz]ed")
        self.assertEqual(base.end()[0], 0)
        wrong = self.write("wrong", "user=gate\npasswort=sesame\n")
        code, _, err = rubric("run", *sink, "--credentials", wrong)
        self.assertEqual(code, 64)
        self.assertIn(f"{wrong}:2: expected user=, password=", err)
        self.assertNotIn("sesame", err)
        gone = self.folder / "gone"
        self.refused(("run", *sink, "--credentials", gone), f"{gone}: cannot be read", 66)

    def tls_broker(self, asks=False):
        """Makes the broker one with TLS. The file of credentials, written, and its lines but for
        that of the authority."""
        certificates(self.folder)
        self.broker.stop()
        self.broker = Broker(self, self.broker.port, self.folder, asks)
        secret = f"user={USER['RUBRIC_MQTT_USER']}\npassword={USER['RUBRIC_MQTT_PASSWORD']}\n"
        users = self.folder / "gate"
        users.write_text(secret + f"ca={self.folder}/ca.crt\n", encoding="utf-8")
        return users, secret

    def test_tls(self):
        users, secret = self.tls_broker()
        subscriber = Subscriber(self, self.broker)
        base, air = self.island(11, "--credentials", users)
        self.mote(5, air)
        subscriber.until(lambda topic, _: topic == "rubicon/11/motes/5/state", "state")
        self.assertEqual(base.end()[0], 0)
        subscriber.state("rubicon/11/availability", "offline")
        # By nobody whom this host trusts; a slow host answers when the library is in its thread.
        users.write_text(secret, encoding="utf-8")
        for url in (self.broker.url, f"mqtts://127.0.0.1:{slow_host(self)}/rubicon"):
            stranger = self.started("base-station", "--island", 12, "--space", url,
                                    "--credentials", users)
            stranger.waits_for(rb"(mqtts://\S+: no TLS: its certificate is not trusted "
                               rb"\(ca= in --credentials\) or names another host)")
            self.assertEqual(stranger.end(None)[0], 66)
        # A host that cuts each connection is tried again, at a leisurely pace.
        cutter = self.started("base-station", "--island", 12, "--space",
                              f"mqtts://127.0.0.1:{cutting_host(self)}/rubicon",
                              "--credentials", users)
        cutter.waits_for(rb"(mqtts://\S+: The connection was lost)")
        time.sleep(1)
        before = os.times()
        self.assertEqual(cutter.end()[0], 0)
        after = os.times()
        self.assertLess(after.children_user + after.children_system -
                        before.children_user - before.children_system, 0.3)
        # And in plain text.
        plain = self.started("base-station", "--island", 12, "--space",
                             self.broker.url.replace("mqtts", "mqtt"), "--credentials", users)
        self.assertNotIn("connected", plain.waits_for(rb"mqtt://\S+: (.*)\n"))

    def test_tls_and_the_broker_goes_and_comes(self):
        users, _ = self.tls_broker()
        base, _ = self.island(11, "--credentials", users)
        for stop in (self.broker.stop, self.broker.kill):
            stop()
            base.waits_for(rb"(mqtts://\S+: the connection is lost)")
            self.broker.start()
            base.waits_for(rb"(mqtts://\S+: connected)")
        self.assertEqual(base.end()[0], 0)

    def test_tls_by_a_certificate(self):
        users, _ = self.tls_broker(asks=True)
        secret = users.read_text(encoding="utf-8")
        own = f"cert={self.folder}/host.crt\nkey={self.folder}/host.key\n"
        users.write_text(secret + own, encoding="utf-8")
        base = self.started("base-station", "--island", 12, "--space", self.broker.url,
                            "--credentials", users)
        base.waits_for(rb"(mqtts://\S+: connected)")
        self.assertEqual(base.end()[0], 0)
        users.write_text(secret, encoding="utf-8")
        base = self.started("base-station", "--island", 12, "--space", self.broker.url,
                            "--credentials", users)
        base.waits_for(rb"(it asks for one \(cert=, key=\))")
        self.assertEqual(base.end(None)[0], 66)
        for text, wrong in ((secret + "cert=/none\n", "gate:4: /none cannot be read"),
                            (secret + own.split("\n")[0], "cert= and key= belong together")):
            users.write_text(text, encoding="utf-8")
            self.refused(("run", "base-station", "--island", 12, "--space", self.broker.url,
                          "--credentials", users), wrong)

    def test_two_base_stations_of_an_island(self):
        subscriber = Subscriber(self, self.broker, "rubicon/11/availability")
        one, _ = self.island(11)
        subscriber.state("rubicon/11/availability", "online")
        two = self.started("base-station", "--island", 11, "--space", self.broker.url,
                           env={**os.environ, **USER})
        one.waits_for(rb"(another base station of island 11 is there since \S+; both take)")
        self.assertEqual(two.end()[0], 0)
        # The one that is left says that the island is there.
        subscriber.state("rubicon/11/availability", "offline")
        subscriber.seen.clear()
        subscriber.state("rubicon/11/availability", "online")
        code, _, err = one.end()
        self.assertEqual(code, 0)
        self.assertNotIn("another", err)

    def test_the_schema_refuses(self):
        for topic, payload in (
                ("rubicon/11/motes/5/state", {"creator": "11:null", "time": "2026-01-31",
                                              "data": {"light": {"raw": 1}}}),
                ("rubicon/11/availability", {"state": "online"}),
                ("rubicon/11/motes/5/set", {"command": "a", "data": "00"})):
            self.assertIsNotNone(wrong_in(topic, payload))
        readme = (ROOT / "spec/space/README.md").read_text(encoding="utf-8")
        for text in re.findall(r"set -m '(.*)'", readme):
            self.assertIsNone(wrong_in("rubicon/11/motes/5/set", json.loads(text)))
        shown = re.search(r"rubicon/11/motes/5/state\n    (\{.*\n.*\})\n", readme)[1]
        self.assertIsNone(wrong_in("rubicon/11/motes/5/state", json.loads(shown)))


if __name__ == "__main__":
    unittest.main()
