/* Whether the person who logs in is at this machine: the face before its camera is then his or
 * hers. Somebody who logs in from elsewhere could wait until the owner sits there. */
#ifndef LOGIN_PLACE_H
#define LOGIN_PLACE_H

#include <stdbool.h>

/* What PAM and the login manager know; each text may be NULL. */
struct login_place {
    const char *service, *rhost, *tty; /* PAM_SERVICE, PAM_RHOST, PAM_TTY */
    bool remote_session;               /* the calling process belongs to a session from elsewhere */
};

/* Why the person is not at this machine: a constant. NULL if nothing says so. */
const char *login_place_remote(const struct login_place *place);

/* Whether the calling process belongs to a session that the login manager (systemd-logind) knows to
 * be from elsewhere, such as `sudo` within SSH. False if it knows no session of this process. */
bool login_place_in_remote_session(void);

#endif
