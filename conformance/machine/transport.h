// Connectionless and Rubicon ACK: awaited acks, and the messages to be acked. (paper: Rubicon ACK)
#pragma once

#include "conformance/machine/actions.h"
#include "conformance/machine/state.h"

namespace rubric::machine {

using AwaitedList = BoundedList<Awaited, kAwaitedMax>;

/// Notes that a reliable message is accepted and its ack is awaited. Not when the list is full.
void await_ack(AwaitedList& list, std::uint16_t seq_num, std::uint8_t app_id, Address dest);
/// Starts its time when it leaves. (decision 110)
void start_ack_timer(AwaitedList& list, const Profile& profile, Ticks now, std::uint16_t seq_num);
/// Handles an ack: T3-SUCCESS, T3-MATCH, T3-ONCE, T3-SENDER.
void hear_ack(AwaitedList& list, Address from, std::uint8_t app_id, std::uint16_t seq_num,
              Actions& actions);
/// Handles the timeout of list[index]: T3-TIMEOUT.
void ack_timeout(AwaitedList& list, std::size_t index, Actions& actions);
/// Returns whether a sequence number must not be used now (N12-REUSE).
bool is_awaited(const AwaitedList& list, std::uint16_t seq_num);
/// Returns the next number: N12-REUSE, N12-ERROR.
std::uint16_t next_seq_num(Sequence& sequence, const AwaitedList& list);

/// Returns whether a Connectionless message may name this application component (T1-UNKNOWN).
bool is_known_app(std::uint8_t app_id);
/// Returns whether Connectionless answers a message with an ack: T2.
bool must_ack(bool reliable, Address dest, std::uint8_t trans_id, std::uint8_t app_id);
/// Returns the acknowledged number in the body of an ack, paper's form (2 bytes) or deployed form
/// (type, number, code); -1 if it is neither.
std::int32_t acked_seq_num(Bytes body);

}  // namespace rubric::machine
