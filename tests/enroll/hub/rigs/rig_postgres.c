#include "tests/enroll/hub/rigs/rig_postgres.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <libpq-fe.h>
#include <pwd.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/scratch.h"

/* Finds the newest version's programs. */
static bool find_programs(struct rig_postgres *rig)
{
    glob_t found;
    const bool exist = glob("/usr/lib/postgresql/*/bin/initdb", 0, NULL, &found) == 0;
    if (exist) {
        const char *last = found.gl_pathv[found.gl_pathc - 1];
        (void)snprintf(rig->programs, sizeof rig->programs, "%.*s",
                       (int)(strlen(last) - strlen("/initdb")), last);
        globfree(&found);
    }
    return exist;
}

/* In the child: the user of the cluster, who must not be root. */
static void become_user(void)
{
    const struct passwd *user = geteuid() == 0 ? getpwnam("postgres") : NULL;
    if (user && (setgid(user->pw_gid) || setuid(user->pw_uid))) {
        _exit(126);
    }
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
}

/* Starts a program of the cluster's user with its output in the file "output". */
static pid_t start(const struct rig_postgres *rig, const char *const argv[])
{
    char output[96];
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        (void)snprintf(output, sizeof output, "%s/output", rig->directory);
        become_user();
        const int fd = open(output, O_WRONLY | O_CREAT | O_APPEND, 0600);
        if (fd < 0 || dup2(fd, STDOUT_FILENO) < 0 || dup2(fd, STDERR_FILENO) < 0 ||
            chdir(rig->directory)) {
            _exit(126);
        }
        (void)execv(argv[0], (char *const *)(uintptr_t)argv);
        _exit(127);
    }
    return pid;
}

static void run(const struct rig_postgres *rig, const char *const argv[])
{
    int status = 0;
    const pid_t pid = start(rig, argv);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        char *output = scratch_read_text(scratch_path(rig->directory, "output"));
        fail_msg("%s failed:\n%s", argv[0], output);
    }
}

static const char *program(const struct rig_postgres *rig, const char *name)
{
    return scratch_path(rig->programs, name);
}

/* The connection string of another database of the cluster. */
static void conninfo_of(const struct rig_postgres *rig, const char *database, char *out,
                        size_t size)
{
    (void)snprintf(out, size, "host=%s user=hub dbname=%s", rig->directory, database);
}

void rig_postgres_up(struct rig_postgres *rig)
{
    char conninfo[160];
    const struct timespec pause = {.tv_nsec = 20000000};
    const char *const argv[] = {program(rig, "postgres"),
                                "-D",
                                scratch_path(rig->directory, "data"),
                                "-k",
                                rig->directory,
                                "-c",
                                "listen_addresses=",
                                "-c",
                                "shared_buffers=16MB",
                                "-c",
                                "log_min_messages=fatal",
                                NULL};
    rig->pid = start(rig, argv);
    conninfo_of(rig, "postgres", conninfo, sizeof conninfo);
    for (int i = 0; PQping(conninfo) != PQPING_OK; i++) {
        assert_true(i < 3000);
        assert_int_equal(waitpid(rig->pid, NULL, WNOHANG), 0);
        (void)nanosleep(&pause, NULL);
    }
}

void rig_postgres_down(struct rig_postgres *rig)
{
    if (rig->pid) {
        assert_int_equal(kill(rig->pid, SIGINT), 0);
        assert_int_equal(waitpid(rig->pid, NULL, 0), rig->pid);
        rig->pid = 0;
    }
}

/* A statement in the database "postgres". */
static void administer(const struct rig_postgres *rig, const char *sql)
{
    char conninfo[160];
    conninfo_of(rig, "postgres", conninfo, sizeof conninfo);
    PGconn *connection = PQconnectdb(conninfo);
    PGresult *result = PQexec(connection, sql);
    if (PQresultStatus(result) != PGRES_COMMAND_OK) {
        fail_msg("%s: %s", sql, PQerrorMessage(connection));
    }
    PQclear(result);
    PQfinish(connection);
}

bool rig_postgres_start(struct rig_postgres *rig)
{
    const struct passwd *user = geteuid() == 0 ? getpwnam("postgres") : NULL;
    *rig = (struct rig_postgres){.pid = 0};
    if (!find_programs(rig) || (geteuid() == 0 && !user)) {
        print_message("PostgreSQL's server is not installed; its tests are left out\n");
        return false;
    }
    strcpy(rig->directory, "/tmp/isotherm-pg-XXXXXX");
    assert_non_null(mkdtemp(rig->directory));
    if (user) {
        assert_int_equal(chown(rig->directory, user->pw_uid, user->pw_gid), 0);
    }
    const char *const argv[] = {program(rig, "initdb"),
                                "-D",
                                scratch_path(rig->directory, "data"),
                                "-U",
                                "hub",
                                "-A",
                                "trust",
                                "-E",
                                "UTF8",
                                "--locale=C",
                                "--no-sync",
                                NULL};
    run(rig, argv);
    conninfo_of(rig, "fleet", rig->conninfo, sizeof rig->conninfo);
    rig_postgres_up(rig);
    administer(rig, "CREATE DATABASE fleet");
    return true;
}

void rig_postgres_stop(struct rig_postgres *rig)
{
    if (rig->directory[0]) {
        const char *const argv[] = {"/bin/rm", "-rf", scratch_path(rig->directory, "data"),
                                    scratch_path(rig->directory, "backup"), NULL};
        rig_postgres_down(rig);
        run(rig, argv);
        (void)unlink(scratch_path(rig->directory, "output"));
        (void)unlink(scratch_path(rig->directory, "dump"));
        assert_int_equal(rmdir(rig->directory), 0);
    }
}

void rig_postgres_empty(struct rig_postgres *rig)
{
    administer(rig, "DROP DATABASE IF EXISTS fleet WITH (FORCE)");
    administer(rig, "CREATE DATABASE fleet");
}

static void copy(struct rig_postgres *rig, const char *from, const char *to)
{
    const char *const removal[] = {"/bin/rm", "-rf", scratch_path(rig->directory, to), NULL};
    const char *const argv[] = {"/bin/cp", "-a", scratch_path(rig->directory, from),
                                scratch_path(rig->directory, to), NULL};
    rig_postgres_down(rig);
    run(rig, removal);
    run(rig, argv);
    rig_postgres_up(rig);
}

void rig_postgres_backup(struct rig_postgres *rig)
{
    copy(rig, "data", "backup");
}

void rig_postgres_restore(struct rig_postgres *rig)
{
    copy(rig, "backup", "data");
}

char *rig_postgres_dump(struct rig_postgres *rig)
{
    const char *path = scratch_path(rig->directory, "dump");
    const char *const argv[] = {program(rig, "pg_dump"), "-f", path, "-d", rig->conninfo, NULL};
    run(rig, argv);
    return scratch_read_text(path);
}
