#include "enroll/hub/broker/hub_options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int hub_options_read(int argc, char **argv, const struct option *longs,
                     int (*take)(int option, const char *value, void *context), void *context)
{
    int option, r = 0;

    optind = 1;
    while (r == 0 && (option = getopt_long(argc, argv, "", longs, NULL)) != -1) {
        r = take(option, optarg, context);
        if (r == -EINVAL) {
            fprintf(stderr, "isotherm-hub: %s: is not allowed here\n", optarg);
        }
    }
    if (r == 0 && optind < argc) {
        fprintf(stderr, "isotherm-hub: %s: %s: takes no words\n", argv[0], argv[optind]);
        r = -EINVAL;
    }
    return r;
}

int hub_port_read(const char *text, unsigned long least, uint16_t *out)
{
    char *end = NULL;
    const unsigned long value = strtoul(text, &end, 10);

    if (end == text || *end || value < least || value > UINT16_MAX) {
        return -EINVAL;
    }
    *out = (uint16_t)value;
    return 0;
}

int hub_hosts_add(struct hub_hosts *hosts, const char *name)
{
    if (hosts->n == HUB_PAIR_HOSTS_MOST) {
        return -EINVAL;
    }
    hosts->names[hosts->n++] = name;
    return 0;
}

void hub_hosts_complete(struct hub_hosts *hosts)
{
    if (hosts->n == 0) {
        (void)gethostname(hosts->own, sizeof hosts->own - 1);
        hosts->names[hosts->n++] = hosts->own;
    }
}
