// SPDX-License-Identifier: Apache-2.0
/// @file
/// Who looks at a stream beside LCM: the live page, PlotJuggler.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bench/live/view/page_server.h"
#include "bench/live/view/plotjuggler.h"

namespace tauext::live {

/// Those that were asked for.
class Viewers {
 public:
  /// @param page port of the page, 0 for any; none: no page
  /// @param plotjuggler HOST:PORT; "": none
  /// @param title what is shown, for the page
  /// @throws as PageServer and PlotJuggler
  Viewers(std::optional<int> page, const std::string& plotjuggler, const std::string& title) {
    if (page) page_.emplace(*page, title);
    if (!plotjuggler.empty()) plotjuggler_.emplace(plotjuggler);
  }

  bool page_is_unseen() const { return page_ && !page_->is_watched(); }  ///< nobody has opened it
  bool any() const { return page_ || plotjuggler_; }                     ///< whether somebody looks
  /// ", page at http://.., JSON to ..", or "".
  std::string where() const {
    return (page_ ? ", page at " + page_->url() : "") +
           (plotjuggler_ ? ", JSON to " + plotjuggler_->to() : "");
  }
  /// Hands on a message; waits for nobody.
  void take(std::string_view channel, Bytes message) {
    if (page_) page_->put(channel, message);
    if (plotjuggler_) plotjuggler_->send(channel, message);
  }
  /// Sends the page what is left. The last call, and no other at the same time.
  void close() { page_.reset(); }

 private:
  std::optional<PageServer> page_;
  std::optional<PlotJuggler> plotjuggler_;
};

}  // namespace tauext::live
