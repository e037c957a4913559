// SPDX-License-Identifier: Apache-2.0
/// @file
/// A plug-in of your own estimators and detectors for tauext-gate, which compares two commits of
/// it:
///
///     \#include <bench/kit/kernels.h>
///     TAUEXT_PLUGIN(kernels) {
///       const tauext::WallMoBot3 arm;
///       kernels.add_estimator("wallmobot3", arm, Mine(arm));
///     }
/// in a source that CMake's tauext_add_plugin(target source) builds. Needs Eigen alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "bench/kit/plugin.h"
#include "estimators/concepts.h"

#ifndef TAUEXT_PLUGIN_FLAGS
/// What it was compiled with; tauext_add_plugin says it.
#define TAUEXT_PLUGIN_FLAGS "unknown"
#endif
/// @cond
#define TAUEXT_STRING_(x) #x
#define TAUEXT_STRING(x) TAUEXT_STRING_(x)
/// @endcond
/// Like "3.4.0".
#define TAUEXT_EIGEN_VERSION         \
  TAUEXT_STRING(EIGEN_WORLD_VERSION) \
  "." TAUEXT_STRING(EIGEN_MAJOR_VERSION) "." TAUEXT_STRING(EIGEN_MINOR_VERSION)

namespace tauext {

/// One kernel at work on its samples.
class KernelInstance {
 public:
  virtual ~KernelInstance() = default;
  virtual void run(int steps) noexcept = 0;  ///< so many of its samples, from the next one on
};

/// What it takes to make one.
class Kernel {
 public:
  /// Of that name.
  explicit Kernel(std::string its_name) : name(std::move(its_name)) {}
  virtual ~Kernel() = default;
  virtual int sample_size() const = 0;                     ///< doubles of one sample
  virtual void example(int n, double* samples) const = 0;  ///< writes n samples to try it on
  virtual KernelInstance* create(
      int n, const double* samples) const = 0;  ///< at work on n samples; to be deleted

  const std::string name;  ///< unique in a plug-in
};

namespace detail {

// the compiler has to compute x and may not know what it is used for
template <class T>
[[gnu::always_inline]] inline void keep(const T& x) {
  asm volatile("" : : "r"(&x) : "memory");
}

// what a kernel of N joints sees of a sample
template <int N>
struct KernelSample {
  Measurement<N> y;
  Vec<N> tau_ext;
};

// where an object lies in its page decides about stalls between stores and loads: by up to 6 % of a
// detector's step. So each kernel's data begin a page of their own, in every plug-in
inline constexpr std::size_t kPage = 4096;

template <class T>
struct PageAllocator {
  using value_type = T;
  PageAllocator() = default;
  template <class U>
  explicit PageAllocator(const PageAllocator<U>&) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(kPage)));
  }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(kPage)); }
  bool operator==(const PageAllocator&) const = default;
};

template <int N>
using KernelSamples = std::vector<KernelSample<N>, PageAllocator<KernelSample<N>>>;

template <int N>
KernelSamples<N> unpack(int n, const double* x) {
  KernelSamples<N> out(n);
  for (KernelSample<N>& s : out) {
    s.y.t = *x++;
    for (Vec<N>* v : {&s.y.q, &s.y.qd, &s.y.tau, &s.tau_ext}) {
      for (int j = 0; j < N; ++j) (*v)[j] = *x++;
    }
  }
  return out;
}

// reset() at the first sample, step(sample) at each: in this order for ever
template <int N, class Subject, class Reset, class Step>
class alignas(kPage) Instance final : public KernelInstance {
 public:
  Instance(Subject s, Reset reset, Step step, int n, const double* samples)
      : subject_(std::move(s)), reset_(reset), step_(step), samples_(unpack<N>(n, samples)) {}

  void run(int steps) noexcept override {
    while (steps > 0) {
      if (next_ == 0) reset_(subject_);
      const int n = std::min(steps, static_cast<int>(samples_.size()) - next_);
      for (int k = next_; k < next_ + n; ++k) step_(subject_, samples_[k]);
      steps -= n;
      next_ = next_ + n == static_cast<int>(samples_.size()) ? 0 : next_ + n;
    }
  }

 private:
  Subject subject_;
  Reset reset_;
  Step step_;
  KernelSamples<N> samples_;
  int next_ = 0;
};

// what does not depend on the subject, compiled once for each arm
template <RobotModel M>
class KernelOfArm : public Kernel {
 public:
  static constexpr int N = M::kDof;

  KernelOfArm(std::string kernel_name, const M& model)
      : Kernel(std::move(kernel_name)), model_(model) {}

  int sample_size() const override { return 1 + 4 * N; }

  // q = 0.3 sin(2 t) in every joint, tau from (3); a blow of 200 N m and 30 ms every half second,
  // sensors with 1e-4 rad/s of noise
  void example(int n, double* x) const override {
    std::uint64_t random = 1;
    const auto noise = [&] {  // Knuth's linear congruential generator, -0.5 to 0.5
      random = random * 6364136223846793005u + 1442695040888963407u;
      return static_cast<double>(random >> 11) * 0x1p-53 - 0.5;
    };
    for (int k = 0; k < n; ++k) {
      const double t = 1e-3 * k, phase = std::fmod(t, 0.5) - 0.4;
      const double blow =
          phase < 0 || phase > 0.03 ? 0 : 200 * std::sin(3.141592653589793 / 0.03 * phase);
      const Vec<N> q = Vec<N>::Constant(0.3 * std::sin(2 * t));
      const Vec<N> qd = Vec<N>::Constant(0.6 * std::cos(2 * t));
      const Vec<N> qdd = -4 * q, tau_ext = Vec<N>::Constant(10 * std::sin(t) + blow);
      const Vec<N> tau =
          model_.inertia(q) * qdd + model_.bias(q, qd) + model_.friction(qd) + tau_ext;
      *x++ = t;
      for (int j = 0; j < N; ++j) *x++ = q[j];
      for (int j = 0; j < N; ++j) *x++ = qd[j] + 3.46e-4 * noise();
      for (int j = 0; j < N; ++j) *x++ = tau[j];
      for (int j = 0; j < N; ++j) *x++ = tau_ext[j] + noise();
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

  KernelInstance* create(int n, const double* samples) const override {
    return new Instance<M::kDof, Subject, Reset, Step>(subject_, reset_, step_, n, samples);
  }

 private:
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

  /// A detector for that arm, as `ROBOT/kName`.
  template <RobotModel M, CollisionDetector D>
  void add_detector(const std::string& robot, const M& arm, D detector) {
    static_assert(D::kDof == M::kDof, "detector and arm have different numbers of joints");
    add(
        robot + "/" + D::kName, arm, std::move(detector), [](D& d) { d.reset(); },
        [](D& d, const Sample<M>& s) { detail::keep(detect(d, s.y, s.tau_ext)); });
  }

  /// The terms of the arm's model, as `ROBOT/model.TERM`.
  template <RobotModel M>
  void add_model(const std::string& robot, const M& arm) {
    const auto term = [&](const char* name, auto step) {
      add(
          robot + "/model." + name, arm, arm, [](M&) {}, step);
    };
    using S = Sample<M>;
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

inline const tauext_plugin* make_plugin(void (*fill)(Kernels&)) {
  static constexpr auto kernel = [](std::size_t i) { return plugin_kernels().all()[i].get(); };
  static const tauext_plugin plugin = [&] {
    fill(plugin_kernels());
    return tauext_plugin{
        TAUEXT_PLUGIN_ABI,
        static_cast<int>(plugin_kernels().all().size()),
        "GCC-compatible " __VERSION__,
        TAUEXT_PLUGIN_FLAGS,
        TAUEXT_EIGEN_VERSION,
        [](int i) { return kernel(i)->name.c_str(); },
        [](int i) { return kernel(i)->sample_size(); },
        [](int i, int n, double* x) { kernel(i)->example(n, x); },
        [](int i, int n, const double* x) -> void* {
          try {
            return kernel(i)->create(n, x);
          } catch (const std::bad_alloc&) {
            return nullptr;
          }
        },
        [](void* k, int steps) { static_cast<KernelInstance*>(k)->run(steps); },
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
