// SPDX-License-Identifier: Apache-2.0
#include "mjcf/picture/picture.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <stdexcept>
#ifdef TAUEXT_PICTURES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <png.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "mjcf/plant/plant.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"
#endif

namespace tauext {

std::vector<std::string> cameras_of(const Model& robot) {
  std::vector<std::string> names;
  for (int i = 0; i < robot->ncam; ++i) names.push_back(element_name(*robot, mjOBJ_CAMERA, i));
  return names;
}

#ifdef TAUEXT_PICTURES
namespace {

constexpr int kChannels = 3;           // red, green and blue
constexpr unsigned char kPaper = 255;  // where nothing is

void check(const Model& robot, const Eigen::VectorXd& q, const View& view, int dof) {
  if (q.size() != dof)
    throw std::invalid_argument(
        fmt::format("a pose of {} numbers, where the robot has {} joints", q.size(), dof));
  if (!q.allFinite()) throw std::invalid_argument("a pose has a number that is none");
  if (std::min(view.width, view.height) < 16 || std::max(view.width, view.height) > 4096)
    throw std::invalid_argument(
        fmt::format("a picture of {}x{} pixels: 16 to 4096", view.width, view.height));
  if (!view.camera.empty())
    find_known(cameras_of(robot), "camera", view.camera, [](const std::string& c) { return c; });
}

// OpenGL without a screen, while it lives: MuJoCo draws into a buffer of its own
class Canvas {
 public:
  Canvas()
      : display_(
            eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)) {
    constexpr EGLint kAny[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                               EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    if (eglInitialize(display_, nullptr, nullptr) == EGL_FALSE) fail("eglInitialize");
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) fail("eglBindAPI");
    if (eglChooseConfig(display_, kAny, &config, 1, &configs) == EGL_FALSE || configs == 0)
      fail("eglChooseConfig");
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
      fail("eglMakeCurrent");
  }
  ~Canvas() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglTerminate(display_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

 private:
  [[noreturn]] void fail(std::string_view call) {
    const EGLint error = eglGetError();
    eglTerminate(display_);
    throw std::runtime_error(
        fmt::format("EGL gives nothing to draw with: {} fails with {:#x}; Debian's libgl1-mesa-dri "
                    "draws without a graphics card",
                    call, error));
  }

  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

// what MuJoCo draws with; a canvas has to be there
class Drawing {
 public:
  explicit Drawing(const mjModel& m) : m_(m) {
    mjv_defaultScene(&scene_);
    mjv_makeScene(&m, &scene_, 2000);
    mjr_defaultContext(&context_);
    mjr_makeContext(&m, &context_, mjFONTSCALE_100);
    mjr_setBuffer(mjFB_OFFSCREEN, &context_);
  }
  ~Drawing() {
    mjr_freeContext(&context_);
    mjv_freeScene(&scene_);
  }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  // rows from the bottom up
  std::vector<unsigned char> draw(mjData& d, const View& view) {
    mjvOption shown;
    mjv_defaultOption(&shown);
    if (m_.ngeom == 0) shown.flags[mjVIS_INERTIA] = shown.flags[mjVIS_JOINT] = 1;
    mjvCamera camera = camera_of(d, view);
    mjv_updateScene(&m_, &d, &shown, nullptr, &camera, mjCAT_ALL, &scene_);
    const mjrRect all{0, 0, view.width, view.height};
    mjr_render(all, &scene_, &context_);
    std::vector<unsigned char> rgb(static_cast<std::size_t>(view.width) *
                                   static_cast<std::size_t>(view.height) * kChannels);
    std::vector<float> depth(rgb.size() / kChannels);
    mjr_readPixels(rgb.data(), depth.data(), all, &context_);
    if (std::count(m_.tex_type, m_.tex_type + m_.ntex, mjTEXTURE_SKYBOX) > 0) return rgb;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] >= 1) std::fill_n(rgb.begin() + kChannels * i, kChannels, kPaper);
    }
    return rgb;
  }

 private:
  mjvCamera camera_of(const mjData& d, const View& view) const {
    mjvCamera camera;
    mjv_defaultFreeCamera(&m_, &camera);
    camera.azimuth = view.azimuth;
    camera.elevation = view.elevation;
    const auto places = Eigen::Map<const Eigen::Matrix3Xd>(d.xipos + 3, 3, m_.nbody - 1);
    const Eigen::Vector3d low = places.rowwise().minCoeff(), high = places.rowwise().maxCoeff();
    Eigen::Vector3d::Map(camera.lookat) = (low + high) / 2;
    camera.distance = 1.5 * (high - low).norm() + 0.3;
    if (view.camera.empty()) return camera;
    camera.type = mjCAMERA_FIXED;
    camera.fixedcamid = mj_name2id(&m_, mjOBJ_CAMERA, view.camera.c_str());
    return camera;
  }

  const mjModel& m_;
  mjvScene scene_;
  mjrContext context_;
};

std::vector<unsigned char> png_of(const std::vector<unsigned char>& rgb, const View& view) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(view.width);
  image.height = static_cast<png_uint_32>(view.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  const int from_the_bottom = -view.width * kChannels;
  const auto write = [&](void* to) {
    if (png_image_write_to_memory(&image, to, &size, 0, rgb.data(), from_the_bottom, nullptr) == 0)
      throw std::runtime_error(fmt::format("no PNG can be made: {}", image.message));
  };
  write(nullptr);
  std::vector<unsigned char> png(size);
  write(png.data());
  png.resize(size);
  return png;
}

}  // namespace

void write_picture(const Model& robot, const Eigen::VectorXd& q, const View& view,
                   const std::string& path) {
  const Model model = changed(robot, [&](mjModel& m) {
    m.vis.global.offwidth = view.width;
    m.vis.global.offheight = view.height;
    const float orange[] = {0.93F, 0.45F, 0.10F, 1};
    std::copy_n(orange, 4, m.vis.rgba.inertia);
    if (m.nlight > 0) return;  // else the lamp that goes with the camera has to do
    std::fill_n(m.vis.headlight.ambient, 3, 0.4F);
    std::fill_n(m.vis.headlight.diffuse, 3, 0.7F);
  });
  Plant plant(model);
  check(model, q, view, plant.dof());
  plant.set_state(q, Eigen::VectorXd::Zero(q.size()));
  const State d(mj_copyData(nullptr, model.get(), &plant.data()));
  const Canvas canvas;
  const std::vector<unsigned char> png = png_of(Drawing(*model).draw(*d, view), view);
  AtomicFile file(path);
  file.write({reinterpret_cast<const char*>(png.data()), png.size()});
  file.commit();
}

#else

void write_picture(const Model&, const Eigen::VectorXd&, const View&, const std::string&) {
  throw std::runtime_error(
      "pictures are left out of this build: install Debian's libegl-dev and libpng-dev, and "
      "build again");
}

#endif

}  // namespace tauext
