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

TEST_F(CorrectionDiagnosisTest, TimesFromTheAzimuthAreToldOnce) {
  SweepCorrectorReport report;
  const auto linesAfterTwo = [&] {
    testing::internal::CaptureStdout();
    for (int i = 0; i < 2; ++i) diagnosis_.add(ros::Time::now(), {}, Sweep(), {}, report);
    return testing::internal::GetCapturedStdout();
  };
  report.timing.field = TimeField::kUsed;
  report.timing.source = TimingSource::kField;
  EXPECT_EQ(linesAfterTwo(), "");
  report.timing.field = TimeField::kAbsent;
  report.timing.source = TimingSource::kAzimuth;
  const std::string said = linesAfterTwo();
  const std::string line = "the clouds have no time field: the points' times are taken from their azimuth";
  EXPECT_NE(said.find(line), std::string::npos) << said;
  EXPECT_EQ(said.find(line), said.rfind(line)) << said;
}

}  // namespace
}  // namespace fail_aware::correction_diagnosis_test
