// rct/1 for firmware of an ATmega128 in libsimavr.
#include <iostream>

#include "conformance/adapters/firmware/host/avr_board.h"
#include "conformance/adapters/firmware/host/session.h"

int main(int argc, char** argv) {
  using namespace rubric::firmware;
  if (argc < 2) {
    std::cerr << "usage: firmware_avr ELF...\n"
                 "Speaks rct/1; starts the ELF file whose role and channels are asked for.\n";
    return 2;
  }
  try {
    std::vector<Station> stations;
    for (int i = 1; i < argc; ++i) {
      Station station;
      station.board = std::make_unique<AvrBoard>(argv[i]);
      station.bridge = std::make_unique<Bridge>(*station.board);
      station.firmware = station.bridge->greet();
      stations.push_back(std::move(station));
    }
    return serve(stations, "rubric_firmware_avr", "virtual");
  } catch (const std::exception& error) {
    std::cerr << "firmware_avr: " << error.what() << "\n";
    return 1;
  }
}
