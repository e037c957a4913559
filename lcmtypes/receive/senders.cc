// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/senders.h"

#include <arpa/inet.h>
#include <fmt/format.h>

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
  if (current_ == 0) current_ = sender;
  if (sender == current_) {
    if (other_spoke_) crowded(other_);
    other_spoke_ = false;
    heard_ = now;
    return Whose::kOurs;
  }
  if (now - heard_ < kSilence) {
    other_ = sender;
    other_spoke_ = true;
    return Whose::kOther;
  }
  if (sender == before_) crowded(current_);  // slower than our patience, but both speak
  before_ = current_;
  current_ = sender;
  other_spoke_ = false;
  heard_ = now;
  return Whose::kNew;
}

void Senders::crowded(Sender other) noexcept {
  other_ = other;
  crowded_ = true;
}

void Senders::out_of_turn(std::int64_t now) noexcept {
  if (now - out_since_ > kSecond) {
    out_since_ = now;
    out_ = 0;
  }
  if (++out_ >= Sequence::kPatience) crowded_ = true;
}

std::string Senders::trouble() {
  if (!crowded_ || told_) return "";
  told_ = true;
  if (other_ == 0) {
    return "messages come out of turn: there are two senders on the channel, or each message comes "
           "twice";
  }
  return fmt::format("{} and {} both send on the channel; only the first is used",
                     name_of(current_), name_of(other_));
}

}  // namespace tauext
