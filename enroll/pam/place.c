#include "enroll/pam/place.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-login.h>

static bool is_one_of(const char *word, const char *const words[], size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (strcmp(word, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

const char *login_place_remote(const struct login_place *place)
{
    static const char *const services[] = {
        "sshd",    "ssh",         "cockpit", "remote",    "rlogin",  "rsh",     "rexec",
        "telnetd", "xrdp-sesman", "ftp",     "vsftpd",    "proftpd", "samba",   "dovecot",
        "imap",    "pop3",        "smtp",    "pure-ftpd", "http",    "openvpn", "webmin",
        "apache2", "x2goagent",   "xpra",    "vncserver"};
    /* A proxy on this machine serves people elsewhere from 127.0.0.1, so an address is none of
     * these. */
    static const char *const here[] = {"", "localhost"};
    static const char *const ttys[] = {"ssh", "cockpit"};
    if (place->rhost && !is_one_of(place->rhost, here, sizeof here / sizeof *here)) {
        return "the login comes from another machine";
    }
    if (place->service && is_one_of(place->service, services, sizeof services / sizeof *services)) {
        return "this service is for logins from other machines";
    }
    if (place->tty && is_one_of(place->tty, ttys, sizeof ttys / sizeof *ttys)) {
        return "the terminal is on another machine";
    }
    return place->remote_session ? "the session comes from another machine" : NULL;
}

bool login_place_in_remote_session(void)
{
    char *session = NULL;
    const bool remote = sd_pid_get_session(0, &session) >= 0 && sd_session_is_remote(session) > 0;
    free(session);
    return remote;
}
