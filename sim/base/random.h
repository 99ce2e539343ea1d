/* A seeded generator of pseudo-random numbers: the same numbers on every machine.
 *
 * xoshiro256** (Blackman and Vigna 2018) seeded through splitmix64; normal deviates by the polar
 * form of Box and Muller (Marsaglia and Bray 1964). Not for secrets. One struct is one stream, used
 * by one thread. */
#ifndef SIM_BASE_RANDOM_H
#define SIM_BASE_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

struct sim_random {
    uint64_t state[4];
    double spare; /* the second deviate of a pair */
    bool has_spare;
};

/* A stream that is determined by the three numbers. Other numbers give an unrelated stream. */
struct sim_random sim_random_seeded(uint64_t seed, uint64_t stream, uint64_t index);

/* Hashes a name to a number for use as a stream (FNV-1a, 64 bits). */
uint64_t sim_random_hash(const char *text);

/* The next number of the stream: 64 random bits, or a number in the range given here. */
uint64_t sim_random_u64(struct sim_random *random);
double sim_random_unit(struct sim_random *random);                            /* [0, 1) */
double sim_random_between(struct sim_random *random, double from, double to); /* [from, to) */
double sim_random_normal(struct sim_random *random);              /* mean 0, standard deviation 1 */
uint32_t sim_random_below(struct sim_random *random, uint32_t n); /* 0 .. n-1; n >= 1 */

#endif
