// SPDX-License-Identifier: Apache-2.0
/// @file
/// A plug-in of your own estimators and detectors, of which tauext-gate compares two commits:
///
///     \#include <bench/kit/kernels.h>
///     TAUEXT_PLUGIN(kernels) {
///       const tauext::WallMoBot3 arm;
///       kernels.add_estimator("wallmobot3", arm, Mine(arm));
///     }
/// in a source that CMake's tauext_add_plugin(target source) builds. Needs Eigen alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "bench/kit/life.h"
#include "bench/kit/plugin.h"
#include "estimators/concepts.h"

#ifndef TAUEXT_PLUGIN_FLAGS
/// What it was compiled with; tauext_add_plugin says it.
#define TAUEXT_PLUGIN_FLAGS "unknown"
#endif
/// Like "3.4.0".
#define TAUEXT_EIGEN_VERSION            \
  EIGEN_MAKESTRING(EIGEN_WORLD_VERSION) \
  "." EIGEN_MAKESTRING(EIGEN_MAJOR_VERSION) "." EIGEN_MAKESTRING(EIGEN_MINOR_VERSION)

namespace tauext {

namespace detail {

// the compiler has to compute x and may not know what it is used for
template <class T>
[[gnu::always_inline]] inline void keep(const T& x) {
  asm volatile("" : : "r"(&x) : "memory");
}

/// Writes at most so many bytes of it, and gives their number; 0 stands for those of no member.
/// Gives 0 for an object that owns memory elsewhere, of which these bytes say nothing.
template <class T>
int copy_state(const T& object, int most, void* bytes) noexcept {
  // what no copy writes holds what lay there before, which is 0 in one copy and 255 in the other
  alignas(T) unsigned char copies[2][sizeof(T)];
  T* made[2];
  for (int i : {0, 1}) {
    std::memset(copies[i], i == 0 ? 0 : 255, sizeof(T));
    keep(copies[i]);  // else the compiler leaves that out, as a constructor follows,
    made[i] = new (copies[i]) T(object);
    keep(*made[i]);  // and what the constructor writes, as nobody reads it as a T
  }
  // what pads it is left out, too: a copy may take it along
  T plain(object);
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&plain);
#endif
  const auto* const value = reinterpret_cast<const unsigned char*>(&plain);
  auto* const out = static_cast<unsigned char*>(bytes);
  bool known = true;
  for (int i = 0; i < static_cast<int>(sizeof(T)); ++i) {
    const bool same = copies[0][i] == copies[1][i];
    // two copies differ in what they write where each holds an address of its own
    known = known && (same || (copies[0][i] == 0 && copies[1][i] == 255));
    if (i < most) out[i] = same ? value[i] : 0;
  }
  for (T* copy : made) std::destroy_at(copy);
  return known ? static_cast<int>(sizeof(T)) : 0;
}

}  // namespace detail

/// One kernel at work on its samples.
class KernelInstance {
 public:
  virtual ~KernelInstance() = default;
  /// As tauext_plugin says.
  virtual int state(int most, void* bytes) const noexcept = 0;
};

/// What it takes to run one of a plug-in's kernels; tauext_plugin says what each function does.
class Kernel {
 public:
  /// Of that name.
  explicit Kernel(std::string its_name) : name(std::move(its_name)) {}
  virtual ~Kernel() = default;
  /// @cond
  virtual int sample_size() const = 0;
  virtual void life(unsigned seed, int n, double* samples) const = 0;
  virtual int sample_bytes() const = 0;
  virtual void unpack(int n, const double* samples, void* out) const = 0;
  virtual KernelInstance* create(int n, const void* unpacked) const = 0;
  virtual tauext_run runner() const = 0;
  /// @endcond

  const std::string name;  ///< unique in a plug-in
};

namespace detail {

// what a kernel of N joints sees of a sample
template <int N>
struct KernelSample {
  Measurement<N> y;
  Vec<N> tau_ext;
};

// where an object lies in its page decides about stalls between stores and loads: by up to 6 % of a
// detector's step. So each kernel begins a page of its own, in every plug-in
inline constexpr std::size_t kPage = 4096;

// reset() where a recording begins, step(sample) at each
template <int N, class Subject, class Reset, class Step>
class alignas(kPage) Instance final : public KernelInstance {
 public:
  Instance(Subject s, Reset reset, Step step, int n, const void* unpacked)
      : subject_(std::move(s)),
        reset_(reset),
        step_(step),
        samples_(static_cast<const KernelSample<N>*>(unpacked)),
        n_(n) {}

  // a function of its own, whose code is all that is timed
  [[gnu::noinline]] static void run(void* instance, int steps) noexcept {
    Instance& i = *static_cast<Instance*>(static_cast<KernelInstance*>(instance));
    int next = i.next_;
    for (; steps > 0; --steps) {
      const KernelSample<N>& sample = i.samples_[next];
      if (next == 0 || sample.y.t == 0) i.reset_(i.subject_);
      i.step_(i.subject_, sample);
      if (++next == i.n_) next = 0;
    }
    i.next_ = next;
  }

  int state(int most, void* bytes) const noexcept override {
    return detail::copy_state(subject_, most, bytes);
  }

 private:
  Subject subject_;
  Reset reset_;
  Step step_;
  const KernelSample<N>* samples_;
  int n_, next_ = 0;
};

// what does not depend on the subject, compiled once for each arm
template <RobotModel M>
class KernelOfArm : public Kernel {
 public:
  static constexpr int N = M::kDof;

  KernelOfArm(std::string kernel_name, const M& model)
      : Kernel(std::move(kernel_name)), model_(model) {}

  int sample_size() const override { return 1 + 4 * N; }
  int sample_bytes() const override { return sizeof(KernelSample<N>); }

  // tau from (3)
  void life(unsigned seed, int n, double* x) const override {
    Life<N> life(seed, n);
    for (int k = 0; k < n; ++k) {
      LifeMoment<N> m = life.next();
      Measurement<N>& y = m.y;
      y.tau =
          model_.inertia(y.q) * m.qdd + model_.bias(y.q, y.qd) + model_.friction(y.qd) + m.tau_ext;
      m.spoil();
      *x++ = y.t;
      for (const Vec<N>* v : {&y.q, &y.qd, &y.tau, &m.load}) x = std::copy_n(v->data(), N, x);
    }
  }

  void unpack(int n, const double* x, void* out) const override {
    for (int k = 0; k < n; ++k) {
      auto* sample = new (static_cast<KernelSample<N>*>(out) + k) KernelSample<N>;
      sample->y.t = *x++;
      for (Vec<N>* v : {&sample->y.q, &sample->y.qd, &sample->y.tau, &sample->tau_ext})
        std::copy_n(std::exchange(x, x + N), N, v->data());
    }
  }

 private:
  M model_;
};

template <RobotModel M, class Subject, class Reset, class Step>
class KernelOf final : public KernelOfArm<M> {
 public:
  KernelOf(std::string kernel_name, const M& model, Subject s, Reset reset, Step step)
      : KernelOfArm<M>(std::move(kernel_name), model),
        subject_(std::move(s)),
        reset_(reset),
        step_(step) {}

  KernelInstance* create(int n, const void* unpacked) const override {
    return new Worker(subject_, reset_, step_, n, unpacked);
  }
  tauext_run runner() const override { return Worker::run; }

 private:
  using Worker = Instance<M::kDof, Subject, Reset, Step>;

  Subject subject_;
  Reset reset_;
  Step step_;
};

}  // namespace detail

/// The kernels of a plug-in, in the order in which they were added.
class Kernels {
 public:
  /// An estimator of that arm, as `ROBOT/kName`.
  template <RobotModel M, TorqueEstimator E>
  void add_estimator(const std::string& robot, const M& arm, E estimator) {
    static_assert(E::kDof == M::kDof, "estimator and arm have different numbers of joints");
    add(
        robot + "/" + E::kName, arm, std::move(estimator), [](E& e) { e.reset(); },
        [](E& e, const Sample<M>& s) { detail::keep(e.update(s.y)); });
  }

  /// A detector of as many joints for that arm, as `ROBOT/kName`.
  template <RobotModel M, CollisionDetector D>
  void add_detector(const std::string& robot, const M& arm, D detector) {
    add(
        robot + "/" + D::kName, arm, std::move(detector), [](D& d) { d.reset(); },
        [](D& d, const Sample<M>& s) {
          detail::keep(detect(d, s.y.t, s.y.qd, s.y.tau, s.tau_ext));
        });
  }

  /// The terms of the arm's model, as `ROBOT/model.TERM`.
  template <RobotModel M>
  void add_model(const std::string& robot, const M& arm) {
    using S = Sample<M>;
    const auto none = [](M&) {};
    const auto term = [&](const char* name, auto step) {
      add(robot + "/model." + name, arm, arm, none, step);
    };
    term("inertia", [](M& m, const S& s) { detail::keep(Mat<M::kDof>(m.inertia(s.y.q))); });
    term("gravity", [](M& m, const S& s) { detail::keep(Vec<M::kDof>(m.gravity(s.y.q))); });
    term("bias", [](M& m, const S& s) { detail::keep(Vec<M::kDof>(m.bias(s.y.q, s.y.qd))); });
    term("momentum_bias",
         [](M& m, const S& s) { detail::keep(Vec<M::kDof>(m.momentum_bias(s.y.q, s.y.qd))); });
    term("friction", [](M& m, const S& s) { detail::keep(Vec<M::kDof>(m.friction(s.y.qd))); });
    if constexpr (DifferentiableModel<M>) {
      term("forward_dynamics", [](M& m, const S& s) {
        detail::keep(m.forward_dynamics(s.y.q, s.y.qd, Vec<M::kDof>(s.y.tau - s.tau_ext)));
      });
    }
  }

  /// In the order in which they were added.
  const std::vector<std::unique_ptr<Kernel>>& all() const { return all_; }

 private:
  template <RobotModel M>
  using Sample = detail::KernelSample<M::kDof>;

  template <RobotModel M, class Subject, class Reset, class Step>
  void add(std::string name, const M& arm, Subject s, Reset reset, Step step) {
    all_.push_back(std::make_unique<detail::KernelOf<M, Subject, Reset, Step>>(
        std::move(name), arm, std::move(s), reset, step));
  }

  std::vector<std::unique_ptr<Kernel>> all_;
};

namespace detail {

inline Kernels& plugin_kernels() {
  static Kernels all;
  return all;
}

// zeros where the kernels are about to be made: a copy may take along what pads its original, and
// GCC 12 does not clear all that pads a large object
[[gnu::noinline]] inline void clear_stack() {
  unsigned char below[1 << 20];
  std::memset(below, 0, sizeof below);
  keep(below);
}

inline const tauext_plugin* make_plugin(void (*fill)(Kernels&)) {
  static constexpr auto kernel = [](std::size_t i) { return plugin_kernels().all()[i].get(); };
  static const tauext_plugin plugin = [&] {
    clear_stack();
    fill(plugin_kernels());
    return tauext_plugin{
        TAUEXT_PLUGIN_ABI,
        static_cast<int>(plugin_kernels().all().size()),
        "GCC-compatible " __VERSION__,
        TAUEXT_PLUGIN_FLAGS,
        TAUEXT_EIGEN_VERSION,
        [](int i) { return kernel(i)->name.c_str(); },
        [](int i) { return kernel(i)->sample_size(); },
        [](int i, unsigned seed, int n, double* x) { kernel(i)->life(seed, n, x); },
        [](int i) { return kernel(i)->sample_bytes(); },
        [](int i, int n, const double* x, void* out) { kernel(i)->unpack(n, x, out); },
        [](int i, int n, const void* unpacked) -> void* {
          try {
            return kernel(i)->create(n, unpacked);
          } catch (const std::bad_alloc&) {
            return nullptr;
          }
        },
        [](int i) { return kernel(i)->runner(); },
        [](void* k, int most, void* bytes) {
          return static_cast<KernelInstance*>(k)->state(most, bytes);
        },
        [](void* k) { delete static_cast<KernelInstance*>(k); },
    };
  }();
  return &plugin;
}

}  // namespace detail
}  // namespace tauext

// NOLINTBEGIN(bugprone-macro-parentheses): a name of a parameter bears none

/// Followed by a block that adds to `kernels`, once in a plug-in.
#define TAUEXT_PLUGIN(kernels)                                                                 \
  static void tauext_fill_plugin(tauext::Kernels& kernels);                                    \
  extern "C" __attribute__((visibility("default"))) const tauext_plugin* tauext_get_plugin() { \
    return tauext::detail::make_plugin(tauext_fill_plugin);                                    \
  }                                                                                            \
  static void tauext_fill_plugin(tauext::Kernels& kernels)
// NOLINTEND(bugprone-macro-parentheses)
