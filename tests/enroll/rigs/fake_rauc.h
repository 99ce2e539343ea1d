/* A stand-in for RAUC on a private bus: the name, object and interface of the installed service, as
 * far as `isotherm update` uses them. Like RAUC it answers InstallBundle at once, reports its
 * progress as changed properties, ends with the signal Completed, keeps the reason of a failure in
 * LastError, and answers no other method while it installs. It runs in a process of its own. */
#ifndef TEST_FAKE_RAUC_H
#define TEST_FAKE_RAUC_H

#include <stdbool.h>
#include <sys/types.h>

enum fake_rauc_end {
    FAKE_RAUC_COMPLETES, /* with success, or with `error` */
    FAKE_RAUC_DIES,      /* leaves the bus at 40 % */
    FAKE_RAUC_GOES_ON,   /* stays at 40 % */
};

struct fake_rauc_script {
    const char *board; /* of the bundle; NULL: the one of this machine, fake_rauc_board */
    bool foreign_key;  /* Info fails */
    bool mute;         /* the bus answers Info: RAUC does not */
    bool busy;         /* it installs from the beginning, and is at 40 % */
    bool overtaken;    /* another way begins to install just before Info */
    bool installed;    /* an update waits in slot b from the beginning */
    bool spare_is_bad; /* the boot loader cannot start the other slot */
    enum fake_rauc_end end;
    const char *hold;  /* while there is a file of this name it stays at 40 %; NULL: none */
    const char *error; /* LastError of an installation that fails; NULL: it succeeds */
};

extern const char fake_rauc_board[];

struct fake_rauc {
    pid_t pid;
    int trace_fd;
};

/* Is the service in this process until it is ended, and then returns a negative number. Writes a
 * byte to ready_fd once it is on the bus, and what it is asked to standard error. */
int fake_rauc_serve(const char *address, const struct fake_rauc_script *script, int ready_fd);

/* Returns when the service is on the bus. */
void fake_rauc_start(struct fake_rauc *rauc, const char *address,
                     const struct fake_rauc_script *script);

/* Ends it and returns what it was asked, such as "Info /tmp/b;InstallBundle /tmp/b;". The text is
 * valid until the next call. */
const char *fake_rauc_stop(struct fake_rauc *rauc);

#endif
