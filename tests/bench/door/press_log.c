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

/* When the edge was in the pipe at the latest: this program had written it, or the daemon read it.
 */
static int64_t sent_ns(const struct bench_press *press)
{
    return press->written_ns < press->on.read_ns ? press->written_ns : press->on.read_ns;
}

/* The delay of the relay beyond the debouncing, or the delay of its end beyond unlock_ms, whichever
 * is longer. *ending: whether it is that of the end. */
static double late_ms(const struct bench_press *press, const struct bench_press_bounds *bounds,
                      bool *ending)
{
    const double on_ms = bench_press_to_line_ms(press) - bounds->debounce_ms;
    const double off_ms = bench_press_off_error_ms(press, bounds->unlock_ms);
    *ending = off_ms > on_ms;
    return *ending ? off_ms : on_ms;
}

/* The cause that explains more than half of the delay, or a page fault that read from the disk. "-"
 * for a delay below 1 ms. The order matters: a thread whose processor is stopped also waits for
 * everything else. */
static const char *cause_of(const struct bench_press *press,
                            const struct bench_press_bounds *bounds, bool watched)
{
    bool ending = false;
    const double half_ms = late_ms(press, bounds, &ending) / 2.0;
    const struct bench_wait *wait = ending ? &press->to_off : &press->to_on;
    /* The kernel may count the stolen time before or after the relay is switched. */
    const int64_t stolen_ns = press->to_on.door.stolen_ns + press->to_off.door.stolen_ns;
    if (half_ms < 0.5) {
        return "-";
    }
    if (watched && ms_of(wait->stopped_ns) > half_ms) {
        return ms_of(stolen_ns) > half_ms ? "host" : "host or kernel";
    }
    if (!ending && ms_of(sent_ns(press) - press->pressed_ns) > half_ms) {
        return "this program";
    }
    if (ms_of(ending ? press->off.lock_ns : press->on.lock_ns) > half_ms) {
        return "a mutex";
    }
    if (wait->door.major > 0) {
        return "page faults";
    }
    return ms_of(wait->door.waited_ns) > half_ms ? "other threads" : "not known";
}

static void print_head(void)
{
    printf(
        "the latest presses, in ms. The first four times are since the edge. Of two numbers the "
        "first is until\nthe relay is on, the second until it is off: how long the door's thread "
        "waited for a processor and for\nmutexes, its page faults, how long this program waited "
        "for a processor, how long a processor stopped,\nand what the host took of them\n"
        "%6s %8s %8s %8s %8s %8s | %13s %13s %11s %13s %15s %11s | %s\n",
        "press", "written", "read", "woken", "relay", "off late", "processor", "mutexes",
        "page faults", "this program", "stopped", "host took", "cause");
}

static void print_press(const struct bench_press *presses, int i,
                        const struct bench_press_bounds *bounds, bool watched)
{
    const struct bench_press *press = &presses[i];
    const struct bench_wait *on = &press->to_on, *off = &press->to_off;
    printf("%6d %8.2f %8.2f %8.2f %8.2f %8.2f | %6.2f %6.2f %6.2f %6.2f %5ld %5ld %6.2f %6.2f ", i,
           ms_of(press->written_ns - press->pressed_ns),
           ms_of(press->on.read_ns - press->pressed_ns),
           ms_of(press->on.woken_ns - press->pressed_ns), bench_press_to_line_ms(press),
           bench_press_off_error_ms(press, bounds->unlock_ms), ms_of(on->door.waited_ns),
           ms_of(off->door.waited_ns), ms_of(press->on.lock_ns), ms_of(press->off.lock_ns),
           on->door.minor + on->door.major, off->door.minor + off->door.major,
           ms_of(on->own.waited_ns), ms_of(off->own.waited_ns));
    if (watched) {
        printf("%7.2f %7.2f ", ms_of(on->stopped_ns), ms_of(off->stopped_ns));
    } else {
        printf("%7s %7s ", "?", "?");
    }
    printf("%5.0f %5.0f | %s\n", ms_of(on->door.stolen_ns), ms_of(off->door.stolen_ns),
           cause_of(press, bounds, watched));
}

/* How many presses were later than that one. */
static int later_than(const struct bench_press *presses, int n, int i,
                      const struct bench_press_bounds *bounds)
{
    bool ending;
    const double own_ms = late_ms(&presses[i], bounds, &ending);
    int later = 0;
    for (int k = 0; k < n; k++) {
        later += late_ms(&presses[k], bounds, &ending) > own_ms;
    }
    return later;
}

void bench_press_print_latest(const struct bench_press *presses, int n,
                              const struct bench_press_bounds *bounds, bool watched)
{
    print_head();
    for (int i = 0; i < n; i++) {
        const double off_ms = bench_press_off_error_ms(&presses[i], bounds->unlock_ms);
        const bool late = bench_press_to_line_ms(&presses[i]) > bounds->late_ms ||
                          off_ms > bounds->late_ms || off_ms < -bounds->late_ms;
        if (late || later_than(presses, n, i, bounds) < SHOWN) {
            print_press(presses, i, bounds, watched);
        }
    }
}
