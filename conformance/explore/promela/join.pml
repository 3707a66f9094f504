/* The join protocol of the RUBICON Communication Layer, motes x sinks, for Debian's spin: a second
 * opinion on the explorer, written from the rules J1-J9 and sharing no code with the machine.
 *
 * The air between a mote and a sink keeps its order (with REORDER an ack_join may overtake), holds
 * one copy of a frame at a time, loses frames (LOSS) and delivers some twice (DUPS at most). Time
 * is abstract: a timer that is set may fire at any moment. Every run is finite, so that
 * `eventually' means `before the end'.
 *
 * A flaw is a macro: ACCEPTS_WRONG_SEQ, ONE_PENDING_SEQ, JOINED_ON_LINK_ACK, NO_FAIL,
 * SEVEN_REQUESTS, ANSWERS_MEMBERS, ACKS_WRONG_SEQ. The properties stand at the end, by the names
 * that `rubric explore' has for them.
 */
#ifndef MOTES
#define MOTES 1            /* 1 or 2 */
#endif
#ifndef SINKS
#define SINKS 1            /* 1 or 2; the island of a sink is its number */
#endif
#ifndef CALLS
#define CALLS 1            /* of joinIsland, a mote */
#endif
#ifndef REQUESTS
#define REQUESTS 2         /* a call, at most */
#endif
#ifndef ACKS
#define ACKS 2             /* ack_join, while no link ack comes */
#endif
#ifndef LOSS
#define LOSS 1
#endif
#ifndef DUPS
#define DUPS 1
#endif

#ifdef SEVEN_REQUESTS
#define REQUESTS_SENT (REQUESTS + 2)
#else
#define REQUESTS_SENT REQUESTS
#endif

#define PAIR(m, s) ((m) * SINKS + (s))
#define SEQ(m, call) ((call) * MOTES + (m) + 1)
#define NOBODY 255

mtype = { kRequest, kAckJoin, kOutside, kJoining, kMember };

chan up[MOTES * SINKS] = [3] of { mtype, byte, byte };  /* kind, sequence number, island */
chan down[MOTES * SINKS] = [2] of { byte };             /* the sequence number of a reply */
bool link_ack[MOTES];      /* on its way to the mote */
byte dups = 0;
bool healing = false;      /* faults have stopped */
bool healed[MOTES];        /* and the mote has had its call since */
bool over = false;         /* and everything that could happen has */

mtype phase[MOTES] = kOutside;

/* What the properties remember: seen from outside, not the mote's own variables. */
bool open[MOTES];          /* a call without its terminal event */
byte present[MOTES];       /* the number of the call's requests */
byte sent[MOTES];          /* its requests */
byte heard[MOTES];         /* islands that answered the present number, as bits */
byte chosen[MOTES];        /* islands that it acked in this call, as bits */
byte acked[MOTES];         /* islands that the mote ever acked, as bits */
byte view[MOTES] = NOBODY; /* the island that the application was told of */
byte replied[MOTES * SINKS];  /* the number answered last */
bool member[MOTES * SINKS];   /* the sink's list */
bool armed[MOTES * SINKS];    /* answered since the last moteJoined */

/* What must not happen. */
bool bad_joined, bad_ack, bad_requests, bad_terminal, bad_island, bad_listed, bad_report;
bool bad_admission, bad_answer;

/* What must be possible. */
bool seen_first, seen_second, seen_fail;

/* A frame leaves for one sink: lost, or in flight unless the same frame is already. */
inline to_sink(m, s, kind, seq, island) {
  if
  :: LOSS && !healing -> skip
  :: up[PAIR(m, s)]??[eval(kind), eval(seq), eval(island)] -> skip
  :: !(up[PAIR(m, s)]??[eval(kind), eval(seq), eval(island)]) ->
     if
     :: nfull(up[PAIR(m, s)]) -> up[PAIR(m, s)]!kind, seq, island
     :: full(up[PAIR(m, s)]) -> skip
     fi
  fi
}

inline to_sinks(m, kind, seq, island) {
  to_sink(m, 0, kind, seq, island);
#if SINKS > 1
  to_sink(m, 1, kind, seq, island);
#endif
}

inline send_request(m) {
  requests++;
  sent[m]++;
  if :: sent[m] > REQUESTS -> bad_requests = true :: else fi;
  to_sinks(m, kRequest, seq, 0)
}

inline send_ack(m, s, number) {
  acks++;
  sending = true;
  link_ack[m] = false;
  acked[m] = acked[m] | (1 << s);
  if :: chosen[m] != 0 && chosen[m] != (1 << s) -> bad_island = true :: else fi;
  chosen[m] = chosen[m] | (1 << s);
  if :: number != present[m] || !((heard[m] >> s) & 1) -> bad_ack = true :: else fi;
  to_sinks(m, kAckJoin, number, s)
}

inline tell_joined(m, s) {
  if :: !((heard[m] >> s) & 1) -> bad_joined = true :: else fi;
  if :: !open[m] -> bad_terminal = true :: else fi;
  if :: view[m] != NOBODY -> bad_island = true :: else fi;
  if :: s == 0 -> seen_first = true :: else -> seen_second = true fi;
  open[m] = false;
  view[m] = s
}

inline tell_failed(m) {
  if :: !open[m] -> bad_terminal = true :: else fi;
  seen_fail = true;
  open[m] = false
}

inline hear_reply(m, s, number) {
  if :: open[m] && number == present[m] -> heard[m] = heard[m] | (1 << s) :: else fi;
  if
#ifdef ACCEPTS_WRONG_SEQ
  :: phase[m] == kJoining ->
#else
  :: phase[m] == kJoining && number == seq ->
#endif
     phase[m] = kMember;
     island = s;
     acks = 0;
     send_ack(m, s, seq);
     tell_joined(m, s)
#if defined(ACKS_WRONG_SEQ) || defined(JOINED_ON_LINK_ACK)
  :: phase[m] == kJoining && number != seq && !sending ->
     island = s;
     acks = 0;
     send_ack(m, s, number)
#endif
  :: else
  fi
}

inline send_done(m, confirmed) {
  sending = false;
  link_ack[m] = false;
  if
  :: !(confirmed) && acks < ACKS && phase[m] == kMember -> send_ack(m, island, seq)
#ifdef JOINED_ON_LINK_ACK
  :: (confirmed) && phase[m] == kJoining ->
     phase[m] = kMember;
     tell_joined(m, island)
#endif
  :: else
  fi
}

/* One copy is taken, or, of some, stays and is delivered again. */
#define DUPLICATE (dups < DUPS && !healing)

proctype Mote(byte m) {
  byte calls = 0, requests = 0, acks = 0, seq = 0, number = 0, island = 0;
  bool sending = false;
end:
  do
  :: atomic { phase[m] == kOutside && !open[m] && (calls < CALLS || (healing && !healed[m])) ->
       if :: healing -> healed[m] = true :: else fi;
       phase[m] = kJoining;
       seq = SEQ(m, calls);
       calls++;
       requests = 0;
       open[m] = true;
       present[m] = seq;
       sent[m] = 0;
       heard[m] = 0;
       chosen[m] = 0;
       send_request(m) }
  :: atomic { phase[m] == kJoining && (!healing || timeout) ->
       if
       :: requests < REQUESTS_SENT -> send_request(m)
       :: else ->
          phase[m] = kOutside;
#ifndef NO_FAIL
          tell_failed(m)
#endif
       fi }
  :: atomic { down[PAIR(m, 0)]?number -> hear_reply(m, 0, number); number = 0 }
  :: atomic { DUPLICATE && nempty(down[PAIR(m, 0)]) ->
       dups++; down[PAIR(m, 0)]?<number>; hear_reply(m, 0, number); number = 0 }
#if SINKS > 1
  :: atomic { down[PAIR(m, 1)]?number -> hear_reply(m, 1, number); number = 0 }
  :: atomic { DUPLICATE && nempty(down[PAIR(m, 1)]) ->
       dups++; down[PAIR(m, 1)]?<number>; hear_reply(m, 1, number); number = 0 }
#endif
  :: atomic { sending && link_ack[m] -> send_done(m, true) }
  :: atomic { sending && ((LOSS && !healing) || (healing && timeout)) -> send_done(m, false) }
  od
}

inline reply_to(s, m, number) {
  replied[PAIR(m, s)] = number;
  armed[PAIR(m, s)] = true;
  if :: member[PAIR(m, s)] -> bad_answer = true :: else fi;
  if
  :: LOSS && !healing -> skip
  :: down[PAIR(m, s)]??[eval(number)] -> skip
  :: !(down[PAIR(m, s)]??[eval(number)]) ->
     if
     :: nfull(down[PAIR(m, s)]) -> down[PAIR(m, s)]!number
     :: full(down[PAIR(m, s)]) -> skip
     fi
  fi
}

#ifdef ANSWERS_MEMBERS
#define LISTED(m) false
#else
#define LISTED(m) member[PAIR(m, s)]
#endif

inline hear(s, m, kind, number, to) {
  if
  :: kind == kRequest && !LISTED(m) ->
#ifdef ONE_PENDING_SEQ
     pending[0] = NOBODY;
#if MOTES > 1
     pending[1] = NOBODY;
#endif
#endif
     pending[m] = number;
     reply_to(s, m, number)
  :: kind == kAckJoin ->
     link_ack[m] = true;
     if
     :: to == s && pending[m] == number ->
        if :: !armed[PAIR(m, s)] -> bad_report = true :: else fi;
        armed[PAIR(m, s)] = false;
        pending[m] = NOBODY;
        member[PAIR(m, s)] = true
     :: else
     fi;
     if :: to == s && replied[PAIR(m, s)] == number && !member[PAIR(m, s)] -> bad_admission = true
     :: else
     fi
  :: else
  fi;
  if :: member[PAIR(m, s)] && !((acked[m] >> s) & 1) -> bad_listed = true :: else fi
}

proctype Sink(byte s) {
  byte pending[MOTES] = NOBODY;
  byte number = 0, to = 0;
  mtype kind = kRequest;
end:
  do
  :: atomic { up[PAIR(0, s)]?kind, number, to -> hear(s, 0, kind, number, to);
              kind = kRequest; number = 0; to = 0 }
  :: atomic { DUPLICATE && nempty(up[PAIR(0, s)]) ->
              dups++; up[PAIR(0, s)]?<kind, number, to>; hear(s, 0, kind, number, to);
              kind = kRequest; number = 0; to = 0 }
#ifdef REORDER
  :: atomic { up[PAIR(0, s)]??kAckJoin, number, to -> hear(s, 0, kAckJoin, number, to);
              number = 0; to = 0 }
#endif
#if MOTES > 1
  :: atomic { up[PAIR(1, s)]?kind, number, to -> hear(s, 1, kind, number, to);
              kind = kRequest; number = 0; to = 0 }
  :: atomic { DUPLICATE && nempty(up[PAIR(1, s)]) ->
              dups++; up[PAIR(1, s)]?<kind, number, to>; hear(s, 1, kind, number, to);
              kind = kRequest; number = 0; to = 0 }
#endif
  od
}

#if MOTES > 1
#define SOMEBODY_JOINS (phase[0] == kJoining || phase[1] == kJoining)
#define ALL_MEMBERS (phase[0] == kMember && phase[1] == kMember)
#define SOMETHING_OPEN (open[0] || open[1])
#else
#define SOMEBODY_JOINS (phase[0] == kJoining)
#define ALL_MEMBERS (phase[0] == kMember)
#define SOMETHING_OPEN open[0]
#endif

init {
  atomic {
    run Mote(0);
    run Sink(0);
#if MOTES > 1
    run Mote(1);
#endif
#if SINKS > 1
    run Sink(1);
#endif
  }
  /* Nothing can go on without faults or calls: now one call of each mote outside must succeed. */
  timeout && !SOMEBODY_JOINS -> healing = true;
  timeout && !SOMEBODY_JOINS -> over = true
}

ltl joined_after_reply { [] !bad_joined }
ltl ack_right_seq { [] !bad_ack }
ltl requests_bounded { [] !bad_requests }
ltl one_terminal { [] !bad_terminal && [] (SOMETHING_OPEN -> <> !SOMETHING_OPEN) }
ltl one_island { [] !bad_island }
ltl listed_acked { [] !bad_listed }
ltl one_report { [] !bad_report }
ltl admitted { [] !bad_admission }
ltl listed_silent { [] !bad_answer }
ltl join_succeeds { [] (over -> ALL_MEMBERS) }
/* These must be violated: what they deny has to be reachable. */
ltl never_first { [] !seen_first }
ltl never_second { [] !seen_second }
ltl never_fail { [] !seen_fail }
ltl never_over { [] !over }
