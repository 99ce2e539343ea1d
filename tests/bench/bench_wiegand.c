/* Measures the timing of Wiegand codes: the lengths of the pulses and of the intervals between them
 * that the sender's thread reaches on this machine. It uses simulated lines, which only note the
 * time, or two real lines:
 *
 *   bench_wiegand [CODES [D0 D1]]       lines as in isotherm.conf(5), such as GPIO5 "GPIO6
 * active-low"
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef ISOTHERM_WITH_GPIOD
#include "drivers/door/gpio_line.h"
#endif
#include "drivers/door/wiegand_out.h"
#include "drivers/file/text.h"

enum { BITS = 26, CODES = 40, CODES_MAX = 10000 };

#define CODE UINT64_C(0x2244acd) /* 26 bits, as good as any */

struct wire {
#ifdef ISOTHERM_WITH_GPIOD
    struct iso_gpio_line *lines[2]; /* NULL: simulated */
#endif
    size_t n; /* pulses */
    int64_t *begin_ns, *end_ns;
};

static int64_t clock_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* Notes the time after the line was switched, because it has its level only then. */
static int set_line(void *context, int line, bool pulse)
{
    struct wire *wire = context;
    int error = 0;
#ifdef ISOTHERM_WITH_GPIOD
    if (wire->lines[line]) {
        error = iso_gpio_line_set(wire->lines[line], pulse);
    }
#else
    (void)line;
#endif
    if (pulse) {
        wire->begin_ns[wire->n] = clock_ns();
    } else {
        wire->end_ns[wire->n++] = clock_ns();
    }
    return error;
}

static int open_lines(struct wire *wire, char **texts)
{
#ifdef ISOTHERM_WITH_GPIOD
    for (int i = 0; i < 2; i++) {
        struct iso_gpio_spec spec;
        struct iso_fault fault = {.text = ""};
        int error = iso_gpio_spec_parse("bench_wiegand", texts[i], &spec, &fault);
        if (!error) {
            error = iso_gpio_line_open_output(&spec, false, &wire->lines[i], &fault);
        }
        if (error) {
            fprintf(stderr, "bench_wiegand: %s\n", fault.text);
            return error;
        }
    }
    return 0;
#else
    (void)wire;
    (void)texts;
    fputs("bench_wiegand: built without libgpiod\n", stderr);
    return -ENOSYS;
#endif
}

static void close_lines(struct wire *wire)
{
#ifdef ISOTHERM_WITH_GPIOD
    iso_gpio_line_close(wire->lines[0]);
    iso_gpio_line_close(wire->lines[1]);
#endif
    free(wire->begin_ns);
    free(wire->end_ns);
}

static int by_value(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static void print_spread(const char *name, int64_t *ns, size_t n)
{
    qsort(ns, n, sizeof *ns, by_value);
    printf("%-10s us  min %8.1f  median %8.1f  p99 %8.1f  max %8.1f  of %zu\n", name,
           (double)ns[0] / 1e3, (double)ns[n / 2] / 1e3, (double)ns[n * 99 / 100] / 1e3,
           (double)ns[n - 1] / 1e3, n);
}

static void print_times(const struct wire *wire)
{
    int64_t *ns = calloc(wire->n, sizeof *ns);
    size_t n = 0;
    if (!ns) {
        return;
    }
    for (size_t i = 0; i < wire->n; i++) {
        ns[i] = wire->end_ns[i] - wire->begin_ns[i];
    }
    print_spread("pulse", ns, wire->n);
    for (size_t i = 1; i < wire->n; i++) {
        if (i % BITS != 0) {
            ns[n++] = wire->begin_ns[i] - wire->begin_ns[i - 1];
        }
    }
    print_spread("interval", ns, n);
    free(ns);
}

static int measure(struct wire *wire, size_t codes)
{
    const struct iso_wiegand_lines lines = {set_line, wire};
    struct iso_wiegand_out *out = NULL;
    struct iso_wiegand_report report;
    struct iso_fault fault = {.text = ""};
    int error = iso_wiegand_out_new(&lines, &out, &fault);
    for (size_t i = 0; !error && i < codes; i++) {
        error = iso_wiegand_out_send(out, CODE, BITS);
        if (!error) {
            error = iso_wiegand_out_flush(out);
        }
    }
    if (error) {
        fprintf(stderr, "bench_wiegand: %s\n", fault.text[0] ? fault.text : strerror(-error));
        iso_wiegand_out_free(out);
        return error;
    }
    iso_wiegand_out_report(out, &report);
    iso_wiegand_out_free(out);
    printf("%s, %zu codes of %d bits\n", report.realtime ? "SCHED_FIFO" : "without SCHED_FIFO",
           codes, BITS);
    print_times(wire);
    return 0;
}

int main(int argc, char **argv)
{
    size_t codes = CODES;
    struct wire wire = {.n = 0};
    if ((argc != 1 && argc != 2 && argc != 4) ||
        (argc > 1 && (iso_text_count(argv[1], &codes) || codes < 1 || codes > CODES_MAX))) {
        fprintf(stderr, "usage: %s [CODES [D0 D1]]\n", argv[0]);
        return 2;
    }
    wire.begin_ns = calloc(codes * BITS, sizeof *wire.begin_ns);
    wire.end_ns = calloc(codes * BITS, sizeof *wire.end_ns);
    int error = wire.begin_ns && wire.end_ns ? 0 : -ENOMEM;
    if (!error && argc == 4) {
        error = open_lines(&wire, argv + 2);
    }
    if (!error) {
        error = measure(&wire, codes);
    }
    close_lines(&wire);
    return error ? 4 : 0;
}
