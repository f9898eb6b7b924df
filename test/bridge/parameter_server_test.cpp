#include "bridge/parameter_server.hpp"

#include <gtest/gtest.h>

namespace fail_aware::parameter_server_test {
namespace {

XmlRpc::XmlRpcValue vehicleAsLoaded() {
  XmlRpc::XmlRpcValue value;
  for (const auto& [key, field] : toList(VehicleParameters())) value["dynamics"][key] = std::get<double>(field);
  value["cog_in_base"].setSize(3);
  value["cog_in_base"][0] = 0.25;
  value["cog_in_base"][1] = 0;  // yaml's 0 is an int
  value["cog_in_base"][2] = 0.5;
  return value;
}

TEST(ParameterServer, StructsBecomeDottedKeys) {
  XmlRpc::XmlRpcValue value = vehicleAsLoaded();
  value["dynamics"]["mass_kg"] = 1800;
  VehicleFileParameters vehicle;
  fromMap(vehicle, toParameterMap(value));
  EXPECT_EQ(vehicle.dynamics.mass_kg, 1800.0);
  EXPECT_EQ(vehicle.cog_in_base, (std::vector<double>{0.25, 0.0, 0.5}));
}

std::string messageOf(const XmlRpc::XmlRpcValue& value) {
  VehicleFileParameters vehicle;
  try {
    fromMap(vehicle, toParameterMap(value));
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "";
}

TEST(ParameterServer, NamesWhatIsWrong) {
  XmlRpc::XmlRpcValue unknown = vehicleAsLoaded();
  unknown["dynamics"]["mass"] = 1.0;
  EXPECT_NE(messageOf(unknown).find("dynamics.mass"), std::string::npos) << messageOf(unknown);
  XmlRpc::XmlRpcValue missing;
  missing["cog_in_base"] = vehicleAsLoaded()["cog_in_base"];
  EXPECT_NE(messageOf(missing).find("dynamics."), std::string::npos) << messageOf(missing);
  XmlRpc::XmlRpcValue text = vehicleAsLoaded();
  text["cog_in_base"][1] = "left";
  EXPECT_NE(messageOf(text).find("cog_in_base"), std::string::npos) << messageOf(text);
  EXPECT_FALSE(messageOf(XmlRpc::XmlRpcValue(3)).empty());
}

}  // namespace
}  // namespace fail_aware::parameter_server_test
