/* A receiver of webhooks: a real HTTPS server in a thread, with a certificate of its own. It checks
 * each signature by itself, and answers by a script. Failures fail the running cmocka test. */
#ifndef TESTS_ENROLL_HUB_OUTLET_RECEIVER_H
#define TESTS_ENROLL_HUB_OUTLET_RECEIVER_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { RECEIVER_REQUESTS = 4096, RECEIVER_PEM_SIZE = 4096 };

/* A key and a certificate for localhost, which it has signed itself. */
struct receiver_pair {
    char key[RECEIVER_PEM_SIZE], certificate[RECEIVER_PEM_SIZE];
};
void receiver_pair_make(struct receiver_pair *pair);

struct receiver_request {
    char key[64]; /* Idempotency-Key */
    char *body;
    bool is_genuine; /* the signature is right, its time is now, and the other headers are there */
    unsigned status; /* what was answered */
    int64_t at_ms;   /* monotonic */
};

struct receiver {
    struct receiver_pair pair;
    char secret[129];
    uint16_t port;
    struct MHD_Daemon *daemon;
    pthread_mutex_t lock;

    /* under the lock */
    unsigned statuses[16]; /* of the next answers; behind them 200 */
    size_t n_statuses, next_status;
    const char *retry_after, *location; /* of answers other than 200 */
    int delay_ms;                       /* before each answer */
    size_t n;
    struct receiver_request requests[RECEIVER_REQUESTS];
};

void receiver_start(struct receiver *receiver, const char *secret);
void receiver_stop(struct receiver *receiver);

/* The next answers have these statuses. */
void receiver_answer(struct receiver *receiver, size_t n, const unsigned *statuses);

/* Each answer waits so long. */
void receiver_delay(struct receiver *receiver, int ms);

/* Waits until there are `n` requests. Fails after `seconds`. */
void receiver_wait(struct receiver *receiver, size_t n, double seconds);

#endif
