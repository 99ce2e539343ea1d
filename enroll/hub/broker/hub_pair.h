/* The hub's own certificates: a key and a certificate of the hub's authority in two files, which
 * are made and renewed here. The HTTPS server, the broker and the hub's client of the broker each
 * have one pair. */
#ifndef HUB_BROKER_HUB_PAIR_H
#define HUB_BROKER_HUB_PAIR_H

#include <stdbool.h>

#include "enroll/hub/broker/hub_ca.h"

enum {
    HUB_PAIR_DAYS = 397,      /* so long a pair is valid */
    HUB_PAIR_RENEW_DAYS = 60, /* so long before its end it is replaced */
    HUB_PAIR_HOSTS_MOST = 16,
};

/* Whose certificate it is. The word is also the beginning of the names of its files: "https.pem"
 * and "https-key.pem". */
enum hub_pair_use {
    HUB_PAIR_HTTPS,  /* TLS server */
    HUB_PAIR_BROKER, /* TLS server */
    HUB_PAIR_CLIENT, /* TLS client; its name, and the broker's user, is HUB_PAIR_CLIENT_NAME */
    HUB_PAIR_HOME,   /* TLS client: Home Assistant, HUB_PAIR_HOME_NAME */
};

/* No door has this name, because doors are named by a UUID. */
#define HUB_PAIR_CLIENT_NAME "hub"
#define HUB_PAIR_HOME_NAME   "home-assistant"

struct hub_pair {
    char *key, *chain; /* PEM; the chain ends with the authority */
    int64_t ends_s;
    bool is_new; /* it was made by this call */
};

/* Reads the pair of a use from `folder`. It is made anew if there is none, if it is damaged, if it
 * ends soon, if another authority has signed it, or if it lacks one of the `n` names or addresses
 * under which the server is reached. The caller frees *out. A negative errno with a fault: -EINVAL
 * there are too many names, errors of the disk. */
int hub_pair_open(const struct hub_ca *ca, const char *folder, enum hub_pair_use use,
                  const char *const *hosts, size_t n, int64_t now_s, struct hub_pair *out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Wipes and frees the texts. */
void hub_pair_free(struct hub_pair *pair);

/* The names of the files of a use in their folder. */
const char *hub_pair_key_name(enum hub_pair_use use);
const char *hub_pair_chain_name(enum hub_pair_use use);

#endif
