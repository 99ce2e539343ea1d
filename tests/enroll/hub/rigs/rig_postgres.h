/* A PostgreSQL of its own for a test: a new cluster in a temporary directory, reached by a socket
 * in it alone. Run as root it belongs to the user postgres, because PostgreSQL refuses to run as
 * root. Failures fail the running cmocka test. */
#ifndef TESTS_ENROLL_HUB_RIGS_RIG_POSTGRES_H
#define TESTS_ENROLL_HUB_RIGS_RIG_POSTGRES_H

#include <stdbool.h>
#include <sys/types.h>

struct rig_postgres {
    char directory[64], programs[128];
    char conninfo[160]; /* of the database "fleet", which is empty at the beginning */
    pid_t pid;          /* of the server; 0: it is down */
};

/* Makes the cluster and starts the server. Returns false, and prints why, if PostgreSQL is not
 * installed; the test is then to be skipped. */
bool rig_postgres_start(struct rig_postgres *rig);

/* Stops the server and removes the cluster. */
void rig_postgres_stop(struct rig_postgres *rig);

/* Stops the server, which ends all connections; starts it again. */
void rig_postgres_down(struct rig_postgres *rig);
void rig_postgres_up(struct rig_postgres *rig);

/* Empties the database "fleet". No connection may be open. */
void rig_postgres_empty(struct rig_postgres *rig);

/* Copies the whole cluster aside; puts the copy back in its place, as a restored backup does. The
 * server is stopped and started again. */
void rig_postgres_backup(struct rig_postgres *rig);
void rig_postgres_restore(struct rig_postgres *rig);

/* The text of pg_dump with everything in the database. The caller frees it. */
char *rig_postgres_dump(struct rig_postgres *rig);

#endif
