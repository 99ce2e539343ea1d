/* Whether one method errs less than another on the same searches: a paired test over people.
 *
 * The searches of one person are not independent, so the test draws people: each person has the
 * difference between the two methods' numbers of errors. If the methods were equal, every
 * person's difference could have the other sign with the same probability (permutation test of
 * paired differences: Fisher 1935, Pitman 1937). The test is two-sided: p is the share of all
 * choices of signs whose sum is at least as far from 0 as the observed sum. */
#ifndef SIM_LAB_MEASURE_PAIRED_H
#define SIM_LAB_MEASURE_PAIRED_H

#include <stddef.h>
#include <stdint.h>

struct sim_paired {
    size_t first_errors, second_errors; /* of all searches */
    size_t people;                      /* with a search */
    size_t first_better,
        second_better; /* people for whom one method makes fewer errors than the other */
    double p;          /* 1 if the methods differ for no person */
};

/* first[i], second[i]: 1 if the method made an error in search i, otherwise 0. person[i] <
 * n_people is the person of the search. If at most 16 people have a difference, all choices of
 * signs are tried; otherwise 99,999 random choices and the observed one (Davison and Hinkley
 * 1997). The same input gives the same result. -ENOMEM. */
int sim_paired_test(const uint8_t *first, const uint8_t *second, const uint32_t *person, size_t n,
                    uint32_t n_people, struct sim_paired *out) __attribute__((warn_unused_result));

#endif
