#include "../../src/nodelets/correction_diagnosis.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fail_aware::correction_diagnosis_test {
namespace {

class CorrectionDiagnosisTest : public testing::Test {
 protected:
  CorrectionDiagnosisTest() { ros::Time::init(); }

  void add(const CloudReadResult& read, const SweepFindings& findings = {}) {
    diagnosis_.add(ros::Time::now(), read, Sweep(), findings, SweepCorrectorReport());
  }
  std::string summary(const std::string& seam_contradiction = "") {
    diagnostic_updater::DiagnosticStatusWrapper status;
    diagnosis_.diagnose(status, seam_contradiction, 0);
    return status.message;
  }

  CorrectionDiagnosis diagnosis_{SweepTimingParams()};
};

TEST_F(CorrectionDiagnosisTest, SoundSweepsAreCorrected) {
  EXPECT_EQ(summary(), "no sweep yet");
  add({});
  EXPECT_EQ(summary(), "correcting");
}

TEST_F(CorrectionDiagnosisTest, RefusedCloudIsReportedOnce) {
  add({CloudStatus::kEmpty, "no point"});
  EXPECT_EQ(summary("the seam"), "clouds without usable points: no point");
  EXPECT_EQ(summary("the seam"), "the seam");
  add({CloudStatus::kEmpty, "none again"});
  EXPECT_EQ(summary(), "clouds without usable points: none again");
}

TEST_F(CorrectionDiagnosisTest, FindingsLastAsLongAsTheSweep) {
  SweepFindings findings;
  findings.low_visibility = true;
  add({}, findings);
  EXPECT_EQ(summary(), "the sweep is cut short in range");
  findings.frozen = true;
  add({}, findings);
  EXPECT_EQ(summary(), "the sweep is frozen: the driver repeats itself");
  add({});
  EXPECT_EQ(summary(), "correcting");
}

}  // namespace
}  // namespace fail_aware::correction_diagnosis_test
