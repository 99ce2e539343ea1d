/* A program that logs somebody in through PAM: libpam loads the module of the build, by a service
 * file that the rig writes. The rig plays the person and reads what the module logs. */
#ifndef TEST_PAM_RIG_H
#define TEST_PAM_RIG_H

#include <stdbool.h>

/* One login. The caller sets the first part; pam_rig_log_in fills in the second. */
struct pam_login {
    const char *service; /* NULL: "login", which does not ask for Enter */
    const char *user;    /* the name that PAM gets */
    const char *rhost, *tty;
    const char *arguments; /* of the module, after bus= and users=; NULL: timeout=10 */
    const char *next;      /* more lines of the service file; NULL: none */
    const char *answer;  /* what the person types when asked for Enter; NULL: nobody can be asked */
    bool remote_session; /* the login manager says so of this process */
    void (*on_look)(void *context); /* the module says "Look at the camera."; NULL: nothing to do */
    void *context;

    int result;        /* of pam_authenticate() */
    int questions;     /* how often the person was asked */
    bool looked;       /* the camera has looked */
    char told[1024];   /* what the person was told, each text with "; " behind it */
    char logged[1024]; /* the lines for the system's log, each with a newline */
};

/* Where logins go. The directory belongs to the rig and other users may read it. */
struct pam_rig {
    char directory[64];
    char bus[256];   /* the address that the module gets; "": no argument */
    char users[128]; /* the file of the users that the module gets */
};

/* Makes the directory, with a copy of the module. */
void pam_rig_init(struct pam_rig *rig, const char *bus);
void pam_rig_done(struct pam_rig *rig);

/* Writes the file of the users, which belongs to root if the test runs as root. */
void pam_rig_write_users(const struct pam_rig *rig, const char *text);

/* Logs in. The test fails if PAM cannot begin. */
void pam_rig_log_in(const struct pam_rig *rig, struct pam_login *login);

/* Fails the test unless the login has this result of PAM; the message has everything else. */
void pam_rig_expect(const struct pam_login *login, int result);

/* Whether this process is root, which the file of the users needs. Prints the reason for a skip if
 * it is not. */
bool pam_rig_is_root(void);

#endif
