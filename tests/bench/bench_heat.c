/* Measures the product's heat of twelve landmarks and their isotherms, and the alternatives that a
 * user could choose: milliseconds, error, memory, and growth with the number of vertices. It uses
 * one thread and the processor time of that thread, so that other work of the machine is not
 * counted. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/heat/grid/grid_step.h"
#include "sim/base/options.h"
#include "sim/lab/draw/plot.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/machine.h"
#include "tests/bench/peers/heat_method.h"
#include "tests/core/surfaces/reference_heat.h"

enum { SIZES = 7, METHODS_MAX = 8, RADII = 4, REPEATS_MAX = 400 };

static const double sizes[SIZES] = {2000, 5000, 10000, 20000, 40000, 80000, 230000};
static const double radii_mm[RADII] = {10, 18, 30, 40};
enum { SIZE_OF_TABLE = 2, RADIUS_OF_PRODUCT = 1, RADIUS_MOST = 3 };

struct options {
    const char *out;
    int seconds; /* for a method at a size; three runs are made in any case */
    int methods; /* the number of methods, from the first */
};

struct timing {
    double heat_ms, isotherms_ms; /* medians */
    double heat_best_ms;
    int n;
};

static void quit(const char *what, int error)
{
    (void)fprintf(stderr, "bench_heat: %s: %s\n", what, strerror(-error));
    exit(EXIT_FAILURE);
}

/* Opens a method, runs it repeatedly, and closes it. */
static struct timing time_method(const struct heat_method *method, const struct heat_case *c,
                                 int seconds)
{
    static int64_t heat_ns[REPEATS_MAX], isotherms_ns[REPEATS_MAX];
    static struct iso_isotherm curves[ISO_LANDMARKS];
    void *state = method->open(c);
    if (!state) {
        quit(method->name, -ENOMEM);
    }
    for (int i = 0; i < method->n_before; i++) {
        const int error = method->heat(state, c);
        if (error) {
            quit(method->name, error);
        }
    }
    size_t n = 0;
    int64_t begin_ns = sim_thread_cpu_ns(NULL);
    do {
        int64_t start_ns = sim_thread_cpu_ns(NULL);
        int error = method->heat(state, c);
        int64_t between_ns = sim_thread_cpu_ns(NULL);
        if (!error) {
            error = method->isotherms(state, c, curves);
        }
        int64_t end_ns = sim_thread_cpu_ns(NULL);
        if (error) {
            quit(method->name, error);
        }
        heat_ns[n] = between_ns - start_ns;
        isotherms_ns[n++] = end_ns - between_ns;
    } while (n < REPEATS_MAX &&
             (n < 3 || sim_thread_cpu_ns(NULL) - begin_ns < seconds * INT64_C(1000000000)));
    method->close(state);
    return (struct timing){
        .heat_ms = sim_latency_of(heat_ns, n).median_ms,
        .isotherms_ms = sim_latency_of(isotherms_ns, n).median_ms,
        .heat_best_ms = (double)heat_ns[0] * 1e-6, /* they are sorted now */
        .n = (int)n,
    };
}

/* The additional memory of one run in MiB: the difference between the peaks of a process that runs
 * the method and one that does not. NAN if this cannot be measured. */
static double memory_mib(const struct heat_method *method, const struct heat_case *c)
{
    double peak[2] = {0};
    for (int with = 0; with < 2; with++) {
        (void)fflush(NULL);
        pid_t child = fork();
        if (child == 0) {
            static struct iso_isotherm curves[ISO_LANDMARKS];
            void *state = with ? method->open(c) : NULL;
            _exit(with &&
                  (!state || method->heat(state, c) || method->isotherms(state, c, curves)));
        }
        int status = 1;
        struct rusage usage = {0};
        if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) {
            return NAN;
        }
        peak[with] = (double)usage.ru_maxrss / 1024.0;
    }
    return peak[1] - peak[0];
}

/* The reference columns [ISO_LANDMARKS][n_vertices] of one kind of mass matrix. The caller frees
 * them. */
static double *reference_columns(const struct heat_case *c, enum iso_mass mass)
{
    size_t n = (size_t)c->surface.mesh->n_vertices;
    double *columns = calloc(ISO_LANDMARKS * n, sizeof *columns);
    if (!columns) {
        quit("reference", -ENOMEM);
    }
    struct matrices m = matrices_of(c->surface.mesh, mass);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        reference_heat(c->surface.mesh, &m, c->source[l], &c->t_mm2, 1, &columns[(size_t)l * n]);
    }
    matrices_free(&m);
    return columns;
}

/* The root mean square distance between two faces' isotherms where both have points, in mm; *n is
 * the number of points. */
static double rms_between(const struct iso_isotherm a[ISO_LANDMARKS],
                          const struct iso_isotherm b[ISO_LANDMARKS], int *n)
{
    double square = 0.0;
    *n = 0;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int i = 0; i < a[l].n && i < b[l].n; i++) {
            if (a[l].weight[i] > 0.0f && b[l].weight[i] > 0.0f) {
                struct iso_vec3 off = iso_sub(a[l].points_mm[i], b[l].points_mm[i]);
                square += iso_dot(off, off);
                ++*n;
            }
        }
    }
    return sqrt(square / *n);
}

/* The error of a method's isotherms at each radius. */
static void measure_error(const struct heat_method *method, struct heat_case c,
                          const double *reference, double error_mm[RADII], int points[RADII])
{
    static struct iso_isotherm exact[ISO_LANDMARKS], found[ISO_LANDMARKS];
    struct iso_tracer *tracer = NULL;
    void *state = method->open(&c);
    if (!state || iso_tracer_new(c.surface.mesh->n_triangles, &tracer)) {
        quit(method->name, -ENOMEM);
    }
    for (int r = 0; r < RADII; r++) {
        c.radius_mm = radii_mm[r];
        int error = method->heat(state, &c);
        if (!error) {
            error = method->isotherms(state, &c, found);
        }
        if (!error) {
            error = heat_isotherms_on_mesh(tracer, &c, reference, exact);
        }
        if (error) {
            quit(method->name, error);
        }
        error_mm[r] = rms_between(exact, found, &points[r]);
    }
    iso_tracer_free(tracer);
    method->close(state);
}

static void print_errors(const struct heat_case *c, int n_methods)
{
    double *reference[2] = {reference_columns(c, ISO_MASS_CONSISTENT),
                            reference_columns(c, ISO_MASS_LUMPED)};
    printf("\nIsotherms against the reference of eleven digits with the same mass matrix, rms mm"
           " (points)\n%-28s",
           "");
    for (int r = 0; r < RADII; r++) {
        printf("        r = %g", radii_mm[r]);
    }
    for (int i = 0; i < n_methods; i++) {
        const struct heat_method *method = &heat_methods[i];
        double error_mm[RADII];
        int points[RADII];
        measure_error(method, *c, reference[method->mass == ISO_MASS_LUMPED], error_mm, points);
        printf("\n%-28s", method->name);
        for (int r = 0; r < RADII; r++) {
            printf("  %7.4f (%d)", error_mm[r], points[r]);
        }
        printf("%s", method->exact ? "" : "  (a distance, not heat)");
    }
    printf("\n");
    free(reference[0]);
    free(reference[1]);
}

/* Compares the time of heat on the grid with the time of moving its data. */
static void print_bound(const struct heat_case *c, int seconds)
{
    struct heat_case at = *c;
    double gb_s = bench_l2_gb_s();
    printf("\nBound by data: a step by itself reads five planes of A, the vector and the one "
           "before, and"
           " writes\none: 32 bytes a pixel. The second-level cache of this core moves %.1f GB/s; "
           "steps by"
           " %s, %d at once.\n",
           gb_s, iso_grid_stepper().name, ISO_GRID_STEPS_MAX);
    for (int r = RADIUS_OF_PRODUCT; r <= RADIUS_MOST; r += RADIUS_MOST - RADIUS_OF_PRODUCT) {
        at.radius_mm = radii_mm[r];
        void *state = heat_methods[HEAT_METHOD_GRID].open(&at);
        if (!state || heat_methods[HEAT_METHOD_GRID].heat(state, &at)) {
            quit("grid", -ENOMEM);
        }
        double pixels = heat_grid_pixels(state), bound_ms = 32.0 * pixels / gb_s * 1e-6;
        heat_methods[HEAT_METHOD_GRID].close(state);
        struct timing t = time_method(&heat_methods[HEAT_METHOD_GRID], &at, seconds);
        printf(
            "  r = %g mm: %.0f thousand pixel steps, bound %.3f ms; heat takes %.3f ms, %.2f times"
            " that (best %.3f, %.2f); isotherms %.3f ms\n",
            at.radius_mm, pixels * 1e-3, bound_ms, t.heat_ms, t.heat_ms / bound_ms, t.heat_best_ms,
            t.heat_best_ms / bound_ms, t.isotherms_ms);
    }
}

/* Sizes at which a method was run: the first ones. */
static int sizes_run(const double of_method_ms[SIZES])
{
    int n = 0;
    while (n < SIZES && !isnan(of_method_ms[n])) {
        n++;
    }
    return n;
}

/* Prints the times by size, and at the end of each row the power of the vertices as which the time
 * grows, from the first size to the last one of the method. */
static void print_powers(const struct options *options, const double n_vertices[SIZES],
                         double total_ms[METHODS_MAX][SIZES])
{
    printf("\n%-28s", "ms by vertices");
    for (int s = 0; s < SIZES; s++) {
        printf(" %9.0f", n_vertices[s]);
    }
    printf("     power");
    for (int i = 0; i < options->methods; i++) {
        const int last = sizes_run(total_ms[i]) - 1;
        printf("\n%-28s", heat_methods[i].name);
        for (int s = 0; s < SIZES; s++) {
            if (s <= last) {
                printf(" %9.2f", total_ms[i][s]);
            } else {
                printf(" %9s", "-");
            }
        }
        if (last > 0) {
            printf(" %9.2f",
                   log(total_ms[i][last] / total_ms[i][0]) / log(n_vertices[last] / n_vertices[0]));
        }
    }
    printf("\n");
}

/* Prints the times of all methods at all sizes, the table of one size, and the growth. */
static void print_growth(const struct options *options, double n_vertices[SIZES],
                         double total_ms[METHODS_MAX][SIZES])
{
    for (int s = 0; s < SIZES; s++) {
        struct heat_case c = heat_case_of(sizes[s]);
        n_vertices[s] = c.surface.mesh->n_vertices;
        if (s == SIZE_OF_TABLE) {
            printf("%d vertices, %d triangles, 12 landmarks, t = %g mm^2, r = %g mm\n\n"
                   "%-28s %9s %9s %9s %8s %9s %5s\n",
                   c.surface.mesh->n_vertices, c.surface.mesh->n_triangles, c.t_mm2, c.radius_mm,
                   "ms", "heat", "isotherms", "both", "times", "MiB more", "runs");
        }
        for (int i = 0; i < options->methods; i++) {
            const struct heat_method *method = &heat_methods[i];
            if (n_vertices[s] > method->n_max) {
                total_ms[i][s] = NAN;
                continue;
            }
            struct timing t = time_method(method, &c, options->seconds);
            total_ms[i][s] = t.heat_ms + t.isotherms_ms;
            if (s == SIZE_OF_TABLE) {
                printf("%-28s %9.3f %9.3f %9.3f %8.1f %9.1f %5d\n", method->name, t.heat_ms,
                       t.isotherms_ms, total_ms[i][s], total_ms[i][s] / total_ms[0][s],
                       memory_mib(method, &c), t.n);
                (void)fflush(stdout);
            }
        }
        if (s == SIZE_OF_TABLE) {
            print_errors(&c, options->methods);
            print_bound(&c, options->seconds);
        }
        heat_case_done(&c);
    }
    print_powers(options, n_vertices, total_ms);
}

static int plot_growth(const struct options *options, const double n_vertices[SIZES],
                       double total_ms[METHODS_MAX][SIZES], struct iso_fault *fault)
{
    struct sim_series series[METHODS_MAX];
    double low = INFINITY, high = 0.0;
    for (int i = 0; i < options->methods; i++) {
        const int n = sizes_run(total_ms[i]);
        series[i] = (struct sim_series){heat_methods[i].name, SIM_SERIES_MARKED, (size_t)n,
                                        n_vertices, total_ms[i]};
        low = fmin(low, total_ms[i][0]);
        high = fmax(high, total_ms[i][n - 1]);
    }
    const struct sim_plot plot = {
        .title = "Heat of 12 landmarks and their isotherms",
        .subtitle = "one thread, median processor time",
        .legend = SIM_LEGEND_UPPER, /* the y axis leaves room for it */
        .x = {"vertices", SIM_SCALE_LOG, n_vertices[0] * 0.8, n_vertices[SIZES - 1] * 1.25},
        .y = {"milliseconds", SIM_SCALE_LOG, low * 0.5, high * 60.0},
        .n_series = (size_t)options->methods,
        .series = series,
    };
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/heat_vertices.png", options->out);
    return sim_plot_write(&plot, path, fault);
}

static const struct sim_option own_options[] = {
    {"out", "DIR", "an existing directory for the plot; without it there is no plot",
     sim_option_text, offsetof(struct options, out)},
    {"methods", "N", "run only the first N methods", sim_option_int,
     offsetof(struct options, methods)},
    {"seconds", "N", "processor time for a method at a size (1)", sim_option_int,
     offsetof(struct options, seconds)},
};

int main(int argc, char **argv)
{
    struct options options = {.seconds = 1, .methods = n_heat_methods};
    const struct sim_option_set set = {own_options, sizeof own_options / sizeof *own_options,
                                       &options};
    struct iso_fault fault = {.text = ""};
    enum sim_options_outcome outcome = sim_options_parse(argc, argv, &set, 1, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        puts("Usage: bench_heat [OPTION...]\n");
        sim_options_help(&set, 1, stdout);
        return EXIT_SUCCESS;
    }
    if (options.methods < 1 || options.methods > n_heat_methods) {
        options.methods = n_heat_methods;
    }
    if (outcome != SIM_OPTIONS_READ) {
        (void)fprintf(stderr, "bench_heat: %s\n", fault.text);
        return EXIT_FAILURE;
    }
    static double n_vertices[SIZES], total_ms[METHODS_MAX][SIZES];
    bench_print_machine();
    print_growth(&options, n_vertices, total_ms);
    if (options.out && plot_growth(&options, n_vertices, total_ms, &fault)) {
        (void)fprintf(stderr, "bench_heat: %s\n", fault.text);
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
