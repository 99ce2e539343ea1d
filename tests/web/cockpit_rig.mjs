// Cockpit of the run: Debian's cockpit-ws and cockpit-bridge with the page as it is installed, without a login. Cockpit takes the private
// bus for the system bus. A second Cockpit is that of a user of one group.
import { spawnSync } from 'node:child_process';
import { chmodSync, cpSync, existsSync, mkdirSync, readdirSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Browser } from './browser.mjs';
import { eventually, expectEqual } from './check.mjs';
import { freePort, start, stop } from './rig.mjs';

const SHARE = '/usr/share/cockpit';
const PROGRAMS = ['/usr/lib/cockpit/cockpit-ws', '/usr/bin/cockpit-bridge', '/usr/bin/setpriv'];
const NOBODY = 65534;

export const PAGE = '/cockpit/@localhost/isotherm/index.html';

// What is missing for these steps: a sentence, or "".
export function missing() {
  const gone = PROGRAMS.filter((program) => !existsSync(program));
  if (gone.length) {
    return `${gone.join(', ')} is missing: cmake/install_packages.sh web`;
  }
  return process.getuid() === 0 ? '' : 'it needs root, for the rights of users on the bus';
}

// Installs the page as the package cockpit-isotherm has it, beside Cockpit's own files.
export function installPage(rig) {
  const root = join(rig.scratch, 'cockpit-root');
  const done = spawnSync('cmake', ['--install', rig.build, '--component', 'cockpit', '--prefix', '/usr'], { encoding: 'utf8', env: { ...process.env, DESTDIR: root } });
  expectEqual(done.status, 0, `the exit code of cmake --install: ${done.stderr}`);
  const folder = join(root, 'usr/share/cockpit');
  for (const name of readdirSync(SHARE).filter((one) => !existsSync(join(folder, one)))) {
    symlinkSync(join(SHARE, name), join(folder, name));
  }
  return join(root, 'usr/share');
}

export class Cockpit {
  // data: the folder of installPage(). group: the bridge runs as nobody, in this group of the machine alone; without it, as root
  constructor(rig, { data, group }) {
    Object.assign(this, { rig, data, group });
  }

  // Cockpit starts the bridge by one word.
  bridge() {
    if (this.group === undefined) {
      return 'cockpit-bridge';
    }
    const path = join(this.rig.scratch, `bridge-${this.group}`);
    const groups = this.group ? `--groups ${this.group}` : '--clear-groups';
    writeFileSync(path, `#!/bin/sh\nHOME=/nonexistent exec setpriv --reuid ${NOBODY} --regid ${NOBODY} ${groups} cockpit-bridge\n`);
    chmodSync(path, 0o755);
    return path;
  }

  async start() {
    const port = await freePort();
    this.base = `http://127.0.0.1:${port}`;
    const path = `${join(this.rig.build, 'enroll')}:${process.env.PATH}`;
    this.server = start(PROGRAMS[0], [`--local-session=${this.bridge()}`, '--no-tls', '-p', String(port), '-a', '127.0.0.1'],
      this.rig.log(`cockpit-${this.group ?? 'root'}`), { DBUS_SYSTEM_BUS_ADDRESS: this.rig.address, XDG_DATA_DIRS: this.data, PATH: path });
    await eventually('cockpit-ws answers', async () => (await fetch(this.base + PAGE)).ok);
    return this;
  }

  // A browser of its own: it is closed to end all windows at once, as after a crash.
  async browser() {
    const browser = await new Browser({ base: this.base, keyHash: this.rig.keyHash(), scratch: this.rig.scratch }).start();
    this.rig.cockpitBrowsers.push(browser);
    return browser;
  }

  async stop() {
    await stop(this.server);
  }
}
