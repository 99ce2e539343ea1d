/* A door loses its devices again and again, and the daemon must return to service by itself: the
 * cable of the USB camera is unplugged, the camera falls silent or its transfers fail, or the chip
 * of the lines is unplugged. Each time the exit button has unlocked the door just before; the relay
 * must be inactive at the end.
 *
 * The calling script runs the daemon. The camera is on the bench VM_DIRECTORY/bench, and the chip
 * "door" of gpio-sim has the lines of board/qemu. The camera counts the starts of the streams. */
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/support/devices/camera_bench.h"
#include "tests/support/scratch.h"
#include "tests/vm/gpio/gpio_sim.h"
#include "tests/vm/usb/usb_bench.h"

enum { RELAY = 0, REFUSED = 2, CONTACT = 5, BUTTON = 6, TAMPER = 7 };
enum { UNPLUGS = 50, STALLS = 20, REMOVALS = 20 };
enum { PATIENCE_MS = 60000, STEP_MS = 20 };

static const char chip[] = "door";
static char directory[256];
static struct usb_bench *bench;
static int shutter_fd;

/* ---- waiting ---- */

static unsigned starts; /* of streams, so far */

static bool is_streamed_anew(void)
{
    return usb_bench_starts(bench) > starts;
}

static bool relay_is_on(void)
{
    return gpio_sim_voltage(chip, RELAY);
}

static bool relay_is_off(void)
{
    return !relay_is_on();
}

/* The red light is active low: off is a voltage, which only the daemon drives. */
static bool lines_are_held(void)
{
    return gpio_sim_voltage(chip, REFUSED);
}

static int64_t now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000) + now.tv_nsec / 1000000;
}

/* Waits until the condition is true, with or without pictures. */
static void wait_until(bool (*is_so)(void), const char *what, bool pictures)
{
    const int64_t end_ms = now_ms() + PATIENCE_MS;
    while (!is_so()) {
        if (now_ms() > end_ms) {
            fail_msg("not within %d s: %s", PATIENCE_MS / 1000, what);
        }
        if (pictures) {
            camera_bench_press(shutter_fd);
        }
        (void)poll(NULL, 0, STEP_MS);
    }
}

static void rest_inputs(void)
{
    gpio_sim_pull(chip, CONTACT, false);
    gpio_sim_pull(chip, BUTTON, true);
    gpio_sim_pull(chip, TAMPER, false);
}

/* Presses the button until the relay is on: a daemon that is opening its lines does not read them.
 */
static bool button_pulls_the_relay(void)
{
    gpio_sim_pull(chip, BUTTON, false);
    (void)poll(NULL, 0, 100);
    gpio_sim_pull(chip, BUTTON, true);
    (void)poll(NULL, 0, 100);
    return relay_is_on();
}

static void let_out(void)
{
    wait_until(button_pulls_the_relay, "the exit button switches the relay", true);
}

/* ---- losses ---- */

static void the_cable_is_unplugged_fifty_times(void **state)
{
    (void)state;
    for (int i = 0; i < UNPLUGS; i++) {
        starts = usb_bench_starts(bench);
        if (i % 10 == 0) {
            let_out();
        }
        camera_bench_plug(directory, false);
        wait_until(relay_is_off, "the relay falls without a camera", false);
        camera_bench_plug(directory, true);
        wait_until(is_streamed_anew, "the camera is streamed again", false);
        camera_bench_press(shutter_fd);
    }
    print_message("%d times unplugged, %u starts\n", UNPLUGS, usb_bench_starts(bench));
}

static void the_camera_stops_twenty_times(void **state)
{
    (void)state;
    for (int i = 0; i < STALLS; i++) {
        starts = usb_bench_starts(bench);
        if (i % 10 == 0) {
            let_out();
        }
        if (i % 2 == 0) {
            usb_bench_halt(bench);
        }
        wait_until(is_streamed_anew, "a silent camera is opened again", false);
        wait_until(relay_is_off, "the relay falls", true);
    }
    print_message("%d times silent or halted, %u starts\n", STALLS, usb_bench_starts(bench));
}

static void the_lines_are_unplugged_twenty_times(void **state)
{
    (void)state;
    for (int i = 0; i < REMOVALS; i++) {
        wait_until(lines_are_held, "the daemon holds the lines", true);
        let_out();
        gpio_sim_plug(chip, false);
        for (int k = 0; k < 5; k++) { /* some pictures */
            camera_bench_press(shutter_fd);
            (void)poll(NULL, 0, STEP_MS);
        }
        gpio_sim_plug(chip, true);
        rest_inputs();
        wait_until(lines_are_held, "the daemon takes the lines again", true);
        wait_until(relay_is_off, "the relay falls", true);
    }
    print_message("%d times without lines\n", REMOVALS);
}

static int set_up(void **state)
{
    char recording[300];
    struct iso_fault fault = {.text = ""};
    (void)state;
    (void)snprintf(directory, sizeof directory, "%s/bench", getenv("VM_DIRECTORY"));
    (void)snprintf(recording, sizeof recording, "%s/wall", getenv("VM_DIRECTORY"));
    shutter_fd = camera_bench_make(directory, recording, true);
    assert_int_equal(unlink(scratch_path(directory, "slot")), 0); /* an empty scene */
    if (usb_bench_new(directory, false, &bench, &fault)) {
        fail_msg("%s", fault.text);
    }
    rest_inputs();
    wait_until(is_streamed_anew, "the daemon streams", false);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    usb_bench_free(bench);
    camera_bench_leave(shutter_fd);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cable_is_unplugged_fifty_times),
        cmocka_unit_test(the_camera_stops_twenty_times),
        cmocka_unit_test(the_lines_are_unplugged_twenty_times),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
