#include "tests/bench/door/press_log.h"

#include <stdio.h>
#include <stdlib.h>

enum { SHOWN = 5 };

static double ms_of(int64_t ns)
{
    return (double)ns / 1e6;
}

double bench_press_to_line_ms(const struct bench_press *press)
{
    return ms_of(press->on.t_ns - press->pressed_ns);
}

double bench_press_off_error_ms(const struct bench_press *press, double unlock_ms)
{
    return ms_of(press->off.t_ns - press->on.t_ns) - unlock_ms;
}

/* The edge was written, or read already. */
static int64_t sent_ns(const struct bench_press *press)
{
    return press->written_ns < press->on.read_ns ? press->written_ns : press->on.read_ns;
}

/* Which of the things that can keep a press waiting took more than half of what it took too long.
 * The order matters: a thread whose processor stands still waits for everything else as well. */
static const char *cause_of(const struct bench_press *press, double debounce_ms, bool watched)
{
    const double half_ms = (bench_press_to_line_ms(press) - debounce_ms) / 2.0;
    if (half_ms < 0.5) {
        return "-";
    }
    if (watched && ms_of(press->stopped_ns) > half_ms) {
        return ms_of(press->door.stolen_ns) > half_ms ? "host" : "host or kernel";
    }
    if (ms_of(sent_ns(press) - press->pressed_ns) > half_ms) {
        return "this program";
    }
    if (ms_of(press->on.lock_ns) > half_ms) {
        return "a mutex";
    }
    if (press->door.major > 0) {
        return "page faults";
    }
    return ms_of(press->door.waited_ns) > half_ms ? "other threads" : "not known";
}

static void print_head(void)
{
    printf("the latest presses, times in ms; the first four since the edge:\n"
           "%6s %8s %8s %8s %8s %8s | %9s %7s %8s | %8s | %8s %9s %7s | %s\n",
           "press", "written", "read", "woken", "relay", "off late", "processor", "mutexes",
           "faults", "own wait", "stopped", "until off", "stolen", "cause");
}

static void print_press(const struct bench_press *presses, int i, double debounce_ms,
                        double unlock_ms, bool watched)
{
    const struct bench_press *press = &presses[i];
    printf("%6d %8.2f %8.2f %8.2f %8.2f %8.2f | %9.2f %7.2f %4ld+%3ld | %8.2f | ", i,
           ms_of(press->written_ns - press->pressed_ns),
           ms_of(press->on.read_ns - press->pressed_ns),
           ms_of(press->on.woken_ns - press->pressed_ns), bench_press_to_line_ms(press),
           bench_press_off_error_ms(press, unlock_ms), ms_of(press->door.waited_ns),
           ms_of(press->on.lock_ns), press->door.minor, press->door.major,
           ms_of(press->own.waited_ns));
    if (watched) {
        printf("%8.2f %9.2f ", ms_of(press->stopped_ns), ms_of(press->off_stopped_ns));
    } else {
        printf("%8s %9s ", "?", "?");
    }
    printf("%7.0f | %s\n", ms_of(press->door.stolen_ns), cause_of(press, debounce_ms, watched));
}

/* How many presses took longer to the relay than that one. */
static int longer_than(const struct bench_press *presses, int n, int i)
{
    int longer = 0;
    for (int k = 0; k < n; k++) {
        longer += bench_press_to_line_ms(&presses[k]) > bench_press_to_line_ms(&presses[i]);
    }
    return longer;
}

void bench_press_print_latest(const struct bench_press *presses, int n, double debounce_ms,
                              double unlock_ms, double bound_ms, bool watched)
{
    print_head();
    for (int i = 0; i < n; i++) {
        const double off_ms = bench_press_off_error_ms(&presses[i], unlock_ms);
        const bool late = bench_press_to_line_ms(&presses[i]) > bound_ms || off_ms > bound_ms ||
                          off_ms < -bound_ms;
        if (late || longer_than(presses, n, i) < SHOWN) {
            print_press(presses, i, debounce_ms, unlock_ms, watched);
        }
    }
}
