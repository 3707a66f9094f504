// rct/1 for firmware of a Cortex-M3 in QEMU.
#include <cstdlib>
#include <iostream>

#include "conformance/adapters/firmware/host/qemu_board.h"
#include "conformance/adapters/firmware/host/serial_device.h"
#include "conformance/adapters/firmware/host/session.h"

namespace {

using namespace rubric::firmware;

constexpr const char* kUsage =
    "usage: firmware_arm [--real-time] ELF...\n"
    "       firmware_arm --serial-device ISLAND ELF\n"
    "       firmware_arm --serial-tcp ISLAND ELF\n"
    "Speaks rct/1; starts the ELF file whose role and channels are asked for. Its time is "
    "virtual,\n"
    "or with --real-time that of the processor's clock. Or starts a sink and prints the name of a\n"
    "device, or tcp:HOST:PORT, which is its serial line until standard input ends.\n"
    "The emulator is $QEMU_SYSTEM_ARM, else qemu-system-arm.\n";

std::string emulator() {
  const char* const named = std::getenv("QEMU_SYSTEM_ARM");
  return named != nullptr ? named : "qemu-system-arm";
}

int run(const std::vector<std::string>& arguments) {
  const bool over_tcp = arguments[0] == "--serial-tcp";
  if (arguments.size() == 3 && (over_tcp || arguments[0] == "--serial-device")) {
    const auto island = static_cast<std::uint16_t>(number_of(arguments[1], 0xFFFF));
    QemuBoard board(emulator(), arguments[2], QemuBoard::Clock::kBoard);
    return serve_serial_device(board, island, over_tcp);
  }
  const bool real = arguments[0] == "--real-time";
  const auto clock = real ? QemuBoard::Clock::kBoard : QemuBoard::Clock::kBench;
  std::vector<Station> stations;
  for (std::size_t i = real ? 1 : 0; i < arguments.size(); ++i) {
    Station station;
    station.board = std::make_unique<QemuBoard>(emulator(), arguments[i], clock);
    station.bridge = std::make_unique<Bridge>(*station.board);
    station.firmware = station.bridge->greet();
    stations.push_back(std::move(station));
  }
  return serve(stations, "rubric_firmware_arm", real ? "real" : "virtual");
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty() || arguments[0] == "--help") {
    std::cerr << kUsage;
    return 2;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "firmware_arm: " << error.what() << "\n";
    return 1;
  }
}
