# Short commands; CMake does the work (CMakePresets.json).
#
#   make demo     builds, then plays stored frames to a running daemon: an enrolled face opens the door
#   make check    builds and runs every test
#   make vm-check runs the tests that need devices of a kernel, in virtual machines
#   make arm64-check  cross-builds daemon, client and tests for arm64 boards, and runs them under an emulator
#   make arm64-bench  counts the instructions of a frame, stage by stage, on arm64 and on x86-64, by an emulator: some minutes
#   make bench    measures the time of each stage from frame to verdict; compares heat, search and registration with other libraries;
#                 measures memory; builds commit 94f9675 and compares each stage with it
#   make bench-door  measures the time from the exit button to the relay, with a disk that takes 10 s: four minutes
#   make fuzz     gives every parser damaged input for FUZZ_SECONDS; FUZZ_SEED=0 chooses other inputs every time
#   make kills    kills a process that writes gallery, log and keys, KILLS times at random moments
#   make storage-faults  lets every call that changes a file fail, in six ways, and kills before and after it, in every operation
#   make drill    breaks sensor, disk, memory, clock and bus of the appliance by 200 plans of 500 steps
#   make races    runs the tests of code with threads under the thread sanitizer
#   make drill-bites  builds mistakes into a copy of the tree; the tests of faults must find each of them
#   make check-clang  builds with clang and runs every test
#   make check-asan  runs every test under the address and undefined-behaviour sanitizers
#   make nightly  runs the slow checks: check-clang, check-asan, fuzz of NIGHTLY_FUZZ_SECONDS, NIGHTLY_KILLS kills, storage-faults,
#                 packages-arm64, drill, races, drill-bites, fleet-check, fleet-upgrade-check,
#                 image-check, image-check-arm64; it does not run `make levels`
#   make levels   counts refused and admitted visitors at each security level in 3,000 visits: an hour; ICT=DIR has the head model.
#                 GROUP_COUNT=1 STRANGERS=300 ALIKE=100: 600 visits; REAL=DIR also plays visits of real frames
#   make packages makes the Debian packages in build/packages and checks them
#   make packages-arm64  cross-builds the packages for arm64 in build/packages-arm64, next to those for every architecture
#   make install-check  installs the packages, and also runs `make install`, each in a fresh Debian in a container: needs root
#   make image    makes the image of the appliance for amd64 machines with UEFI, build/image/BOARD/isotherm.img: needs root
#   make image-arm64  makes it for arm64 machines with UEFI, build/image-arm64/BOARD/isotherm.img; BOARD is generic here: needs root
#   make image-check  makes the image, starts it as a PC with UEFI under an emulator, damages it, and compares two builds: needs root
#   make image-check-arm64  makes the image for arm64, starts it by its boot loader under an emulator, and damages it: needs root
#   make web-check  tests the web server and its pages in a browser, with a daemon on stored frames; pictures are in out/web-check
#   make hub-web-check  tests the pages of the hub of a fleet in a browser, with a PostgreSQL of its own; pictures are in out/hub-web-check
#   make fleet-check  runs 50 doors, two hubs, PostgreSQL and mosquitto, and kills them at random for FLEET_FAULT_SECONDS
#   make fleet-upgrade-check  upgrades a hub and two doors from the packages of the previous release, in containers, in either order: needs
#                 root. PREVIOUS=REVISION is another release
#   make fleet-bench  measures a hub with FLEET_BENCH_SIZES simulated doors, and the law of what more would need: 20 minutes or more
#   make install  PREFIX=/usr/local, DESTDIR= for packagers
#   make docs     makes the reference of the library for programmers, in build/docs: HTML and manual pages
#   make clean    removes everything that the other commands made

PREFIX ?= /usr/local
FUZZ_SECONDS ?= 20
FUZZ_SEED ?= 1
KILLS ?= 1000
NIGHTLY_KILLS ?= 1000
FLEET_FAULT_SECONDS ?= 600
FLEET_BENCH_SIZES ?= 1000 5000 20000
NIGHTLY_FUZZ_SECONDS ?= 300
ICT ?= ict
BOARD ?= pc-usb
JOBS := $(shell nproc)

.PHONY: demo check check-clang check-asan vm-check arm64-check arm64-bench bench bench-door fuzz kills storage-faults drill races drill-bites nightly levels packages packages-arm64 install-check image image-arm64 image-check image-check-arm64 web-check hub-web-check fleet-check fleet-upgrade-check fleet-bench install docs clean

demo:
	cmake/install_packages.sh build demo
	cmake --preset release
	cmake --build --preset release
	sim/demo.sh build/release out/demo

check:
	cmake/install_packages.sh build test
	cmake --preset dev
	cmake --build --preset dev
	ctest --preset dev -j $(JOBS)

check-clang:
	cmake/install_packages.sh build test gate
	cmake --preset clang
	cmake --build --preset clang
	ctest --preset clang -j $(JOBS)

vm-check: packages
	cmake/install_packages.sh build test vm install
	cmake --preset dev
	cmake --build --preset dev
	cmake --preset asan-ubsan
	cmake --build --preset asan-ubsan --target isothermd isotherm vm_usb_endurance
	tests/vm/run.sh build/dev build/vm

arm64-check:
	cmake/install_packages.sh build test arm64
	tests/aarch64/run.sh build/aarch64

arm64-bench:
	cmake/install_packages.sh build test arm64
	tests/aarch64/instructions.sh

bench:
	cmake/install_packages.sh build test bench
	cmake --preset release -DBUILD_TESTING=ON
	cmake --build --preset release --target bench

bench-door:
	cmake/install_packages.sh build test bench
	cmake --preset release -DBUILD_TESTING=ON
	cmake --build --preset release --target bench-door

fuzz:
	cmake/install_packages.sh build test gate
	cmake --preset fuzz
	cmake --build --preset fuzz
	tests/fuzz/run.sh build/fuzz $(FUZZ_SECONDS) $(FUZZ_SEED)

kills:
	cmake/install_packages.sh build test
	cmake --preset dev
	cmake --build --preset dev --target kill_stores
	tests/firmware/faults/fault_log.sh build/dev kills build/dev/tests/firmware/kill_stores $(KILLS)

storage-faults:
	cmake/install_packages.sh build test
	cmake --preset dev
	cmake --build --preset dev --target storage-faults

drill:
	cmake/install_packages.sh build test
	cmake --preset dev
	cmake --build --preset dev --target drill

races:
	cmake/install_packages.sh build test
	cmake --preset tsan
	cmake --build --preset tsan --target races
	ctest --preset races -j $(JOBS)

drill-bites:
	cmake/install_packages.sh build test
	cmake --preset dev
	tests/firmware/faults/drill_bites.sh build/dev

check-asan:
	cmake/install_packages.sh build test
	cmake --preset asan-ubsan
	cmake --build --preset asan-ubsan
	ctest --preset asan-ubsan -j $(JOBS)

nightly:
	$(MAKE) check-clang
	$(MAKE) check-asan
	$(MAKE) fuzz FUZZ_SECONDS=$(NIGHTLY_FUZZ_SECONDS)
	$(MAKE) kills KILLS=$(NIGHTLY_KILLS)
	$(MAKE) storage-faults
	$(MAKE) packages-arm64
	$(MAKE) drill
	$(MAKE) races
	$(MAKE) drill-bites
	$(MAKE) fleet-check
	$(MAKE) fleet-upgrade-check
	$(MAKE) image-check
	$(MAKE) image-check-arm64
	tests/gate/summary.sh build/dev

levels:
	cmake/install_packages.sh build
	cmake --preset release
	cmake --build --preset release --target isotherm-sim
	sim/door/levels.sh build/release/sim/isotherm-sim $(ICT) core/data out/levels

packages:
	cmake/install_packages.sh build package
	cmake/debian_packages.sh build/packages
	lintian --fail-on error,warning --allow-root build/packages/*.changes

packages-arm64: packages
	cmake/install_packages.sh install
	cmake/debian_packages_arm64.sh build/packages build/packages-arm64

install-check: packages
	cmake/install_packages.sh install
	cmake --preset release
	cmake --build --preset release
	tests/install/run.sh build/packages build/release build/install

image: packages
	cmake/install_packages.sh image
	board/image/build.sh build/packages build/image/$(BOARD) $(BOARD)

image-arm64: BOARD = generic
image-arm64: packages-arm64
	cmake/install_packages.sh image arm64
	ISOTHERM_ARCH=arm64 board/image/build.sh build/packages-arm64 build/image-arm64/$(BOARD) $(BOARD)

image-check: packages
	cmake/install_packages.sh install vm image
	tests/image/run.sh build/packages build/image

image-check-arm64: packages-arm64
	cmake/install_packages.sh install vm image arm64
	ISOTHERM_ARCH=arm64 tests/image/run.sh build/packages-arm64 build/image-arm64

web-check:
	cmake/install_packages.sh build test web
	cmake --preset dev
	cmake --build --preset dev --target isothermd isotherm isotherm-web isotherm-web-pages bench_gallery play_rauc test_screen_picture
	tests/web/run.sh build/dev out/web-check

hub-web-check:
	cmake/install_packages.sh build test web
	cmake --preset dev
	cmake --build --preset dev --target isotherm-hub isotherm-hub-pages play_doors
	tests/web/hub/run.sh build/dev out/hub-web-check

fleet-check:
	cmake/install_packages.sh build test
	cmake --preset dev
	cmake --build --preset dev --target isotherm-hub fleet_doors isothermd isotherm isotherm-link
	tests/fleet/fleet_check.sh build/dev $(FLEET_FAULT_SECONDS)

fleet-upgrade-check: packages
	cmake/install_packages.sh install
	cmake/previous_packages.sh build/packages-previous $(PREVIOUS)
	tests/install/root.sh build/install/base.tar
	tests/install/fleet_upgrade.sh build/packages-previous build/packages build/install/base.tar

fleet-bench:
	cmake/install_packages.sh build test bench
	cmake --preset dev
	cmake --build --preset dev --target isotherm-hub fleet_bench fleet_crowd fleet_poll
	tests/bench/fleet/fleet_bench.sh build/dev out/fleet-bench $(FLEET_BENCH_SIZES)

install:
	cmake/install_packages.sh build
	cmake --preset release -DCMAKE_INSTALL_PREFIX=$(abspath $(PREFIX))
	cmake --build --preset release
	cmake --install build/release
	cmake/after_install.sh "$(DESTDIR)"

docs:
	cmake/install_packages.sh docs
	cmake/docs.sh build/docs

clean:
	rm -rf build out
