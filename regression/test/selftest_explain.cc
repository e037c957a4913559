// SPDX-License-Identifier: Apache-2.0
// What tauext-gate explain prints can be run, and makes the entry's own run; what is gone is told.
#include <cmath>
#include <map>
#include <sstream>

#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

// a CSV file's columns by name
std::map<std::string, std::vector<double>> columns(const std::string& path) {
  std::istringstream in(read_whole(path));
  std::string line, cell;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::map<std::string, std::vector<double>> all;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    for (const std::string& name : names) {
      std::getline(cells, cell, ',');
      all[name].push_back(std::stod(cell));
    }
  }
  return all;
}

// root mean square of estimate - truth, of the joint where it is largest
double worst_rmse(const std::string& log, const std::string& estimates,
                  const std::string& estimator) {
  const auto truth = columns(log), estimate = columns(estimates);
  double worst = 0;
  for (int j = 1; truth.contains("tau_ext" + std::to_string(j)); ++j) {
    const auto& a = truth.at("tau_ext" + std::to_string(j));
    const auto& b = estimate.at(estimator + "_tau_ext" + std::to_string(j));
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b.at(k)) * (a[k] - b.at(k));
    worst = std::max(worst, std::sqrt(sum / static_cast<double>(a.size())));
  }
  return worst;
}

class Explain : public Gate {
 protected:
  // the command among what was printed that begins like that
  std::string printed(const std::string& begin) const {
    const auto at = text_.find("\n  " + begin);
    if (at == std::string::npos) ADD_FAILURE() << begin << " is not in\n" << text_;
    return at == std::string::npos ? "false"
                                   : text_.substr(at + 3, text_.find('\n', at + 1) - at - 3);
  }
  std::string in_folder(const std::string& command) const {
    return run_child(
        {"sh", "-c", "cd '" + folder_.path() + "' && PATH='" + kBin + "':$PATH && " + command});
  }
};

// scenarios whose errors count from their begin; in the first two the detector's mark stops the
// motor
TEST_F(Explain, PrintsCommandsThatReproduceTheEntry) {
  for (const std::string entry : {"wallmobot3/contact/mo2+pan_tompkins",
                                  "testbed1/collision/ekf+pan_tompkins", "wallmobot3/step/ndob"}) {
    ASSERT_EQ(run({"explain", entry, "--baselines", baselines()}), kGood) << text_;
    const std::string record = printed("tauext-record "), replay = printed("tauext-replay ");
    const Golden golden = parse_golden(in_folder(printed(kBin + "/tauext-bench ")), "golden");
    ASSERT_EQ(golden.seeds, std::vector<std::string>{"seed 1"});
    in_folder(record);
    in_folder(replay);
    const std::string pair = entry.substr(entry.rfind('/') + 1);
    const double rmse = worst_rmse(folder_.path() + "/log.csv", folder_.path() + "/est.csv",
                                   pair.substr(0, pair.find('+')));
    EXPECT_NEAR(rmse, golden.lines.at({entry, "rmse_Nm"}).values.at(0), 1e-9 * (1 + rmse))
        << record << '\n'
        << replay;
  }
}

TEST_F(Explain, SaysThatAKernelIsGoneFromHead) {
  EXPECT_EQ(run({"explain", "testbed1/mo1", "--base", kBin + "/tauext_plugin.so", "--head",
                 plugin("base"), "--baselines", baselines()}),
            kGood)
      << text_;
  EXPECT_TRUE(says("testbed1/mo1 is gone from head: base alone has it")) << text_;
}

}  // namespace
}  // namespace tauext::gate::test
