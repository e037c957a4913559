// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/senders.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <utility>

namespace tauext {

std::string name_of(Sender sender) {
  if (sender == 0) return "an unknown sender";
  in_addr address{};
  address.s_addr = htonl(static_cast<std::uint32_t>(sender >> 16));
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &address, text, sizeof text);
  return fmt::format("{}:{}", text, sender & 0xffff);
}

Senders::Whose Senders::take(Sender sender, std::int64_t now) noexcept {
  if (current_ == 0) {
    current_ = sender;
    heard_ = now;
  }
  if (sender == current_) {
    two_known_ = two_known_ || other_spoke_;
    other_spoke_ = false;
    return Whose::kOurs;
  }
  if (now - heard_ < kSilence) {
    other_ = sender;
    other_spoke_ = true;
    return Whose::kOther;
  }
  two_known_ = two_known_ || sender == before_;  // slower than our patience, but both speak
  other_ = before_ = current_;
  current_ = sender;
  other_spoke_ = false;
  heard_ = now;
  return Whose::kNew;
}

void Senders::out_of_turn(std::int64_t now) noexcept {
  if (now - out_since_ > kSecond) {
    out_since_ = now;
    out_ = 0;
  }
  disorder_ = disorder_ || ++out_ >= Sequence::kPatience;
}

std::string Senders::trouble() {
  if (two_known_ && !std::exchange(reported_two_, true)) {
    return fmt::format("{} and {} both send on the channel; only the first is used",
                       name_of(current_), name_of(other_));
  }
  if (disorder_ && !two_known_ && !std::exchange(reported_disorder_, true)) {
    return "messages come out of turn: there are two senders on the channel, or each message comes "
           "twice";
  }
  return "";
}

}  // namespace tauext
