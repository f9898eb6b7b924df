#include "core/io/measurement_log.hpp"

#include "core/io/number_table.hpp"

namespace fail_aware {

namespace {

struct MeasurementLogTable {
  using Row = MeasuredMotion;
  static constexpr const char* kName = "this version's measurements.csv";
  static constexpr const char* kRemedy = "run offline_odometry again";

  template <class Motion, class Visitor>
  static void visit(Motion& motion, Visitor&& v) {
    v("row", motion.row);
    v("source", motion.source);
    number_table::visitMatrix("T_previous_now", motion.T_previous_now.affine(), v);
    number_table::visitMatrix("covariance", motion.covariance, v);
  }
};

}  // namespace

MeasuredMotion measuredMotion(std::size_t row, std::size_t source, const Measurement& measurement,
                              const FilterState& state) {
  const Pose T_previous_odom = state.T_previous_now * state.T_odom_cog.inverse();
  return {row, source, T_previous_odom * measurement.T_odom_cog,
          rotateCovariance(measurement.covariance, T_previous_odom.linear())};
}

std::string measurementLogHeader() { return numberTableHeader<MeasurementLogTable>(); }

std::string measurementLogRow(const MeasuredMotion& motion) { return numberTableRow<MeasurementLogTable>(motion); }

std::vector<MeasuredMotion> readMeasurementLog(const std::string& path) {
  return readNumberTable<MeasurementLogTable>(path);
}

}  // namespace fail_aware
