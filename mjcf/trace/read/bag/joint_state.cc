// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/joint_state.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace tauext {
namespace {

constexpr std::size_t kEncapsulation = 4;  // [bytes] behind which offsets are counted

// numbers are aligned to their size; beyond the end they are 0
class Cdr {
 public:
  Cdr(std::string_view body, bool big) : body_(body), big_(big) {}

  bool cut_off() const { return cut_off_; }
  std::uint32_t integer() { return static_cast<std::uint32_t>(number(4)); }
  double real() { return std::bit_cast<double>(number(8)); }
  std::string_view text() {
    std::string_view s = take(integer());
    if (!s.empty() && s.back() == '\0') s.remove_suffix(1);  // which its length counts
    return s;
  }

 private:
  std::uint64_t number(std::size_t size) {
    take((size - at_ % size) % size);
    std::uint64_t n = 0;
    const std::string_view bytes = take(size);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      n = n << 8 | static_cast<unsigned char>(bytes[big_ ? i : size - 1 - i]);
    }
    return n;
  }
  std::string_view take(std::size_t size) {
    cut_off_ = cut_off_ || size > body_.size() - at_;
    if (cut_off_) return {};
    at_ += size;
    return body_.substr(at_ - size, size);
  }

  std::string_view body_;
  std::size_t at_ = 0;
  bool big_, cut_off_ = false;
};

const char* objection_to_encapsulation(std::string_view bytes) {
  if (bytes.starts_with("\x28\xB5\x2F\xFD")) {
    return "it is compressed: write the bag without compression by ros2 bag convert";
  }
  if (bytes.size() < kEncapsulation) return "it is cut off";
  return bytes[0] == 0 && (bytes[1] == 0 || bytes[1] == 1) ? nullptr : "it is no plain CDR";
}

const char* read_names(Cdr& cdr, std::vector<std::string>& names) {
  const std::size_t count = cdr.integer();
  if (count > kMostJoints) return "it has more than 64 joints";
  names.clear();
  for (std::size_t i = 0; i < count && !cdr.cut_off(); ++i) {
    const std::string_view name = cdr.text();
    if (std::find(names.begin(), names.end(), name) != names.end() && !cdr.cut_off()) {
      return "it names a joint twice";
    }
    names.emplace_back(name);
  }
  if (cdr.cut_off()) return "it is cut off";
  return names.empty() ? "it names no joint" : nullptr;
}

const char* read_numbers(Cdr& cdr, std::size_t joints, std::vector<double>& numbers) {
  const std::size_t count = cdr.integer();
  if (count != 0 && count != joints) return "it has not as many numbers as names";
  numbers.resize(count);
  for (double& x : numbers) x = cdr.real();
  return cdr.cut_off() ? "it is cut off" : nullptr;
}

}  // namespace

const char* read_joint_state(std::string_view bytes, JointState& state) {
  if (const char* why = objection_to_encapsulation(bytes)) return why;
  Cdr cdr(bytes.substr(kEncapsulation), bytes[1] == 0);
  const auto seconds = static_cast<std::int32_t>(cdr.integer());
  state.stamp = seconds + 1e-9 * cdr.integer();
  cdr.text();  // the name of the frame
  const char* why = read_names(cdr, state.name);
  for (auto* numbers : {&state.position, &state.velocity, &state.effort}) {
    if (why == nullptr) why = read_numbers(cdr, state.name.size(), *numbers);
  }
  return why;
}

}  // namespace tauext
