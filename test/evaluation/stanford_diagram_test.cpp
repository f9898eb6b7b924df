#include "evaluation/stanford_diagram.hpp"

#include <gtest/gtest.h>

namespace fail_aware::stanford_diagram_test {
namespace {

TEST(StanfordDiagram, RegionsAndTheirEdges) {
  EXPECT_EQ(integrityRegion(0.1, 0.3, 0.6), IntegrityRegion::kNominal);
  EXPECT_EQ(integrityRegion(0.3, 0.3, 0.6), IntegrityRegion::kNominal);
  EXPECT_EQ(integrityRegion(0.4, 0.3, 0.6), IntegrityRegion::kMisleading);
  EXPECT_EQ(integrityRegion(0.6, 0.3, 0.6), IntegrityRegion::kHazardous);
  EXPECT_EQ(integrityRegion(0.1, 0.6, 0.6), IntegrityRegion::kUnavailable);
  EXPECT_EQ(integrityRegion(0.9, 0.9, 0.6), IntegrityRegion::kUnavailable);
  EXPECT_EQ(integrityRegion(1.0, 0.9, 0.6), IntegrityRegion::kUnavailableMisleading);
}

TEST(StanfordDiagram, Counts) {
  const auto counts = stanfordCounts({{0.1, 0.3}, {0.2, 0.3}, {0.4, 0.3}, {0.7, 0.3}, {1.0, 0.9}}, 0.6);
  EXPECT_EQ(counts, (std::array<std::size_t, kIntegrityRegions>{2, 1, 1, 0, 1}));
  for (std::size_t i = 0; i < kIntegrityRegions; ++i) {
    EXPECT_STRNE(toString(static_cast<IntegrityRegion>(i)), "unknown");
  }
}

}  // namespace
}  // namespace fail_aware::stanford_diagram_test
