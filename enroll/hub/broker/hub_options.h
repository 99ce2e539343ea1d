/* Reading the options of those commands of isotherm-hub that have many: serve and broker-config. */
#ifndef HUB_BROKER_HUB_OPTIONS_H
#define HUB_BROKER_HUB_OPTIONS_H

#include <getopt.h>
#include <limits.h>
#include <stddef.h>
#include <stdint.h>

#include "enroll/hub/broker/hub_pair.h"

/* Passes each option to `take`, whose value NULL means that it has none. A value of `take` other
 * than 0 ends the reading and is returned; for -EINVAL a line about the option's value is printed
 * first. argv[0] is the word of the command, which takes no words: -EINVAL, with a line. */
int hub_options_read(int argc, char **argv, const struct option *longs,
                     int (*take)(int option, const char *value, void *context), void *context)
    __attribute__((warn_unused_result));

/* Reads a port from `least` to 65535. -EINVAL. */
int hub_port_read(const char *text, unsigned long least, uint16_t *out)
    __attribute__((warn_unused_result));

/* Names and addresses of a server. */
struct hub_hosts {
    const char *names[HUB_PAIR_HOSTS_MOST];
    size_t n;
    char own[HOST_NAME_MAX + 1]; /* room for the name of this machine */
};

/* Adds one; the text must outlive the list. -EINVAL there are too many. */
int hub_hosts_add(struct hub_hosts *hosts, const char *name) __attribute__((warn_unused_result));

/* Adds the name of this machine to a list that is empty. */
void hub_hosts_complete(struct hub_hosts *hosts);

#endif
