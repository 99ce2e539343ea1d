/* Measures the registration of two faces by 12 x 32 points: the product's ICP, its closed form, and
 * PCL's ICP on the same points. It prints microseconds, and the largest distance between points
 * that the method and the first method have registered. One thread, processor time.
 *
 * One face has the curves of a made-up face. The other face is the same face moved by a known
 * motion and, in a second run, with a random deviation of each point. Without the deviation every
 * ICP that converges finds the motion itself. With it the result depends on which points may form
 * pairs: PCL takes the nearest of all points, the product takes the nearest of the same curve, so
 * the results may differ. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/registration/icp.h"
#include "core/registration/rigid.h"
#include "sim/base/random.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/machine.h"
#include "tests/bench/peers/icp_pcl.h"

/* The workspace of registrations. */
static struct iso_icp_workspace registration;

enum { GROUPS = 12, IN_GROUP = 32, POINTS = GROUPS * IN_GROUP, PAIRS = 200, ITERATIONS = 100 };

struct pair {
    float source_mm[POINTS][3], target_mm[POINTS][3];
    float weight[POINTS];
};

/* Rings of 18 mm about twelve places of a face, on a paraboloid with some relief, which are similar
 * to isotherms. The source is the target moved by up to 4 degrees and 4 mm. */
static void make_pair(uint64_t number, double deviation_mm, struct pair *pair)
{
    static const double place_mm[GROUPS][2] = {{0, 38},  {0, 0},    {0, -14},   {-17, -3},
                                               {17, -3}, {-16, 36}, {16, 36},   {-46, 35},
                                               {46, 35}, {0, -24},  {-25, -33}, {25, -33}};
    struct sim_random random = sim_random_seeded(3, 1, number);
    const struct iso_vec3 turn = {sim_random_between(&random, -0.07, 0.07),
                                  sim_random_between(&random, -0.07, 0.07),
                                  sim_random_between(&random, -0.07, 0.07)};
    struct iso_rigid motion = {.rotation = iso_mat3_rotation(turn)};
    motion.translation_mm = iso_vec3(sim_random_between(&random, -4, 4),
                                     sim_random_between(&random, -4, 4),
                                     sim_random_between(&random, -4, 4));
    for (int k = 0; k < POINTS; k++) {
        const double angle = 2.0 * M_PI * (k % IN_GROUP) / IN_GROUP;
        const double x = place_mm[k / IN_GROUP][0] + 18.0 * cos(angle);
        const double y = place_mm[k / IN_GROUP][1] + 18.0 * sin(angle);
        const double z = -0.006 * x * x - 0.003 * y * y + 14.0 * exp(-(x * x + y * y) / 350.0) +
                         2.0 * sin(0.11 * x) * cos(0.13 * y);
        const struct iso_vec3 p = iso_rigid_apply(&motion, iso_vec3(x, y, z));
        const double target[3] = {x, y, z}, source[3] = {p.x, p.y, p.z};
        for (int c = 0; c < 3; c++) {
            pair->target_mm[k][c] = (float)target[c];
            pair->source_mm[k][c] = (float)(source[c] + deviation_mm * sim_random_normal(&random));
        }
        pair->weight[k] = 1.0f;
    }
}

/* The motion that a method finds for the source's points. */
typedef int register_function(const struct pair *pair, struct iso_affine *target_from_source);

static int by_icp(const struct pair *pair, struct iso_affine *out, enum iso_icp_pairing pairing)
{
    const struct iso_icp_points source = {GROUPS, IN_GROUP, pair->source_mm, pair->weight};
    const struct iso_icp_points target = {GROUPS, IN_GROUP, pair->target_mm, pair->weight};
    const struct iso_icp_options options = {
        .pairing = pairing, .trim = 1.0, .iterations_max = ITERATIONS, .tolerance_mm = 1e-6};
    struct iso_icp_result result;
    const int error = iso_icp(&registration, &source, &target, &options, &result);
    *out = result.target_from_source;
    return error;
}

static int by_nearest(const struct pair *pair, struct iso_affine *out)
{
    return by_icp(pair, out, ISO_ICP_NEAREST);
}

static int by_order(const struct pair *pair, struct iso_affine *out)
{
    return by_icp(pair, out, ISO_ICP_ORDERED);
}

static int by_closed_form(const struct pair *pair, struct iso_affine *out)
{
    struct iso_vec3 source[POINTS], target[POINTS];
    struct iso_rigid rigid;
    for (int k = 0; k < POINTS; k++) {
        source[k] = iso_vec3((double)pair->source_mm[k][0], (double)pair->source_mm[k][1],
                             (double)pair->source_mm[k][2]);
        target[k] = iso_vec3((double)pair->target_mm[k][0], (double)pair->target_mm[k][1],
                             (double)pair->target_mm[k][2]);
    }
    const int error = iso_rigid_fit(source, target, NULL, POINTS, &rigid);
    *out = iso_affine_of_rigid(&rigid);
    return error;
}

#ifdef HAVE_PCL
static int by_pcl(const struct pair *pair, struct iso_affine *out)
{
    double m[16];
    const int error = peer_pcl_icp(pair->source_mm, pair->target_mm, POINTS, ITERATIONS, 1e-8, m);
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 4; c++) {
            out->m[r][c] = m[4 * r + c];
        }
    }
    return error;
}
#endif

struct method {
    const char *name;
    register_function *run;
};

static const struct method methods[] = {
    {"ICP, nearest of the same curve", by_nearest},
    {"ICP, points in order", by_order},
    {"closed form, points in order", by_closed_form},
#ifdef HAVE_PCL
    {"PCL's ICP", by_pcl},
#endif
};
enum { METHODS = sizeof methods / sizeof *methods };

/* The largest distance between the two positions of a point that both motions have moved, in mm. */
static double apart(const struct pair *pair, const struct iso_affine *a, const struct iso_affine *b)
{
    double most = 0.0;
    for (int k = 0; k < POINTS; k++) {
        const struct iso_vec3 p = iso_vec3((double)pair->source_mm[k][0],
                                           (double)pair->source_mm[k][1],
                                           (double)pair->source_mm[k][2]);
        most = fmax(most, iso_norm(iso_sub(iso_affine_apply(a, p), iso_affine_apply(b, p))));
    }
    return most;
}

static int run(double deviation_mm)
{
    static int64_t took_ns[METHODS][PAIRS];
    static double off_mm[METHODS];
    struct pair pair;
    struct iso_affine found[METHODS];
    for (int i = 0; i < PAIRS; i++) {
        make_pair((uint64_t)i, deviation_mm, &pair);
        for (int m = 0; m < METHODS; m++) {
            const int64_t begin_ns = sim_thread_cpu_ns(NULL);
            const int error = methods[m].run(&pair, &found[m]);
            took_ns[m][i] = sim_thread_cpu_ns(NULL) - begin_ns;
            if (error) {
                (void)fprintf(stderr, "%s: %s\n", methods[m].name, strerror(-error));
                return error;
            }
            off_mm[m] = fmax(i ? off_mm[m] : 0.0, apart(&pair, &found[0], &found[m]));
        }
    }
    printf("\n%d pairs, the same points moved%s\n%-32s %10s %10s %8s %22s\n", PAIRS,
           deviation_mm > 0.0 ? ", each 0.5 mm off besides" : "", "", "median us", "p95 us",
           "times", "largest difference, mm");
    double first_ms = 0.0;
    for (int m = 0; m < METHODS; m++) {
        const struct sim_latency took = sim_latency_of(took_ns[m], PAIRS);
        first_ms = m == 0 ? took.median_ms : first_ms;
        printf("%-32s %10.1f %10.1f %8.1f %22.5f\n", methods[m].name, 1e3 * took.median_ms,
               1e3 * took.p95_ms, took.median_ms / first_ms, off_mm[m]);
    }
    return 0;
}

int main(void)
{
    bench_print_machine();
    int error = run(0.0);
    if (!error) {
        error = run(0.5);
    }
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}
