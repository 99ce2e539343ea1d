#include "tests/bench/machine.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/utsname.h>

#include "sim/lab/match/latency.h"

void bench_print_machine(void)
{
    char line[256], name[128] = "unknown processor";
    FILE *file = fopen("/proc/cpuinfo", "re");
    while (file && fgets(line, sizeof line, file)) {
        if (sscanf(line, "model name : %127[^\n]", name) == 1) {
            break;
        }
    }
    if (file) {
        fclose(file);
    }
    struct utsname system;
    if (uname(&system) == 0) {
        printf("%s, %s %s %s\n", name, system.sysname, system.release, system.machine);
    }
}

void bench_print_memory(void)
{
    char line[128];
    long now_kib = 0, peak_kib = 0;
    FILE *file = fopen("/proc/self/status", "re");
    while (file && fgets(line, sizeof line, file)) {
        (void)sscanf(line, "VmRSS: %ld", &now_kib);
        (void)sscanf(line, "VmHWM: %ld", &peak_kib);
    }
    if (file) {
        fclose(file);
        printf("resident memory: %.1f MiB, at most %.1f MiB\n", (double)now_kib / 1024.0,
               (double)peak_kib / 1024.0);
    }
}

enum { STREAMS = 8, FLOATS = 8192, PASSES = 400, LANES = 8 };

typedef float lanes __attribute__((vector_size(LANES * sizeof(float))));

/* Compiled with the same vector instructions as the fastest heat step. */
#if defined __x86_64__
__attribute__((target("avx2")))
#endif
static void
stream(float *const plane[STREAMS])
{
    for (int i = 0; i < FLOATS; i += LANES) {
        lanes a = *(const lanes *)&plane[0][i] + *(const lanes *)&plane[1][i];
        lanes b = *(const lanes *)&plane[2][i] + *(const lanes *)&plane[3][i];
        lanes c = *(const lanes *)&plane[4][i] + *(const lanes *)&plane[5][i];
        *(lanes *)&plane[7][i] = a + b + (c + *(const lanes *)&plane[6][i]);
    }
}

double bench_l2_gb_s(void)
{
    float *memory = aligned_alloc(64, STREAMS * FLOATS * sizeof *memory);
    if (!memory) {
        return 0.0;
    }
    float *plane[STREAMS];
    for (int s = 0; s < STREAMS; s++) {
        plane[s] = &memory[s * FLOATS];
    }
    for (int i = 0; i < STREAMS * FLOATS; i++) {
        memory[i] = 1.0f;
    }
    int64_t best_ns = INT64_MAX;
    for (int pass = 0; pass < PASSES; pass++) {
        int64_t begin_ns = sim_wall_ns(NULL);
        for (int k = 0; k < 4; k++) {
            stream(plane);
            __asm__ volatile("" : : "r"(memory) : "memory"); /* keeps the writes */
        }
        int64_t took_ns = sim_wall_ns(NULL) - begin_ns;
        best_ns = took_ns < best_ns ? took_ns : best_ns;
    }
    free(memory);
    return 4.0 * STREAMS * FLOATS * sizeof(float) / (double)best_ns;
}
