"""A small certificate authority of one's own: `onehop keys` makes one for a team, with all certificates.

Everyone's key is made here and sent nowhere: who copies a folder to another host copies one identity.
There is no list of revoked certificates, since Zenoh reads none: an identity that was stolen is good
until it expires, and what ends it at once is a new authority.
"""

import datetime
import ipaddress
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from onehop.contracts import topics
from onehop.contracts.errors import InputError
from onehop.node.certificates import hosts_of, own_certificate
from onehop.node.identity import AUTHORITY, CERTIFICATE, KEY
from onehop.wire.output_folder import explained

AUTHORITY_KEY = "ca-key.pem"
"""Who has this file can make any identity: it stays where it was made."""

ROUTER = "router"
"""A router of its own (zenohd), in the world's place."""

SERVERS = (topics.WORLD, ROUTER)
"""Whom the others connect to."""

LOOPBACK = ("localhost", "127.0.0.1", "::1")
"""Where servers can be reached without being told."""

AUTHORITY_DAYS = 3650
"""How long the authority is good; certificates are for a shorter time, and are issued again."""

EARLIER = datetime.timedelta(days=1)
"""How far a host's clock may be behind: a certificate is good from so long before its issue."""


def names_of(robots: Iterable[int], bases: Iterable[int] = ()) -> tuple[str, ...]:
    """Everyone who needs a certificate. bases: robots with a real one."""
    return (*SERVERS, *topics.clients(robots, bases))


def found(keys: Path) -> None:
    """Make a folder with a new authority in it. Raises InputError when one is there."""
    with explained(keys, "a folder that can be made and written"):
        keys.mkdir(parents=True, exist_ok=True, mode=0o700)
    for path in (keys / AUTHORITY, keys / AUTHORITY_KEY):
        if path.exists():
            remedy = "another folder; --missing adds what is not there, --reissue NAME replaces one"
            raise InputError(str(path), "an authority is there already", remedy)
    key = ec.generate_private_key(ec.SECP256R1())
    name = _name(f"Onehop {keys.resolve().name}")
    usage = _usage(sign=True)
    certificate = (
        _builder(name, name, key.public_key(), AUTHORITY_DAYS)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(usage, critical=True)
        .sign(key, hashes.SHA256())
    )
    _write(keys / AUTHORITY_KEY, _pem(key))
    _write(keys / AUTHORITY, certificate.public_bytes(serialization.Encoding.PEM))


def is_good(keys: Path, name: str) -> bool:
    """Whether this certificate is there, and valid now."""
    try:
        own_certificate(keys, name)
    except InputError:
        return False
    return True


def issue(keys: Path, name: str, hosts: Sequence[str], days: int) -> None:
    """Make the key and certificate of one process; what it had before is replaced.

    hosts: where a server can be reached, beside where the one before could. Raises InputError when there
    is no authority.
    """
    authority, authority_key = _authority(keys)
    key = ec.generate_private_key(ec.SECP256R1())
    issuer_key: Any = authority_key.public_key()
    serves = name in SERVERS
    purposes = [ExtendedKeyUsageOID.CLIENT_AUTH, *([ExtendedKeyUsageOID.SERVER_AUTH] if serves else [])]
    builder = (
        _builder(_name(name), authority.subject, key.public_key(), days)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_usage(sign=False), critical=True)
        .add_extension(x509.ExtendedKeyUsage(purposes), critical=False)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(issuer_key), critical=False)
    )
    if serves:
        before = _hosts_before(keys / name / CERTIFICATE)
        places = [_general_name(host) for host in dict.fromkeys((*LOOPBACK, *before, *hosts))]
        builder = builder.add_extension(x509.SubjectAlternativeName(places), critical=False)
    certificate = builder.sign(authority_key, hashes.SHA256())
    folder = keys / name
    with explained(folder, "a folder that can be made and written"):
        folder.mkdir(exist_ok=True, mode=0o700)
        folder.chmod(0o700)
    _write(folder / AUTHORITY, authority.public_bytes(serialization.Encoding.PEM))
    _write(folder / KEY, _pem(key))
    _write(folder / CERTIFICATE, certificate.public_bytes(serialization.Encoding.PEM))


def _authority(keys: Path) -> tuple[x509.Certificate, Any]:
    path, key_path = keys / AUTHORITY, keys / AUTHORITY_KEY
    remedy = "the folder in which onehop keys has made the authority"
    with explained(key_path, remedy):
        certificate, key = path.read_bytes(), key_path.read_bytes()
    try:
        return (
            x509.load_pem_x509_certificate(certificate),
            serialization.load_pem_private_key(key, password=None),
        )
    except (ValueError, TypeError):
        raise InputError(str(key_path), "is no key of an authority", remedy) from None


def _hosts_before(path: Path) -> tuple[str, ...]:
    try:
        return hosts_of(x509.load_pem_x509_certificate(path.read_bytes()))
    except (OSError, ValueError):
        return ()


def _builder(
    subject: x509.Name, issuer: x509.Name, public: ec.EllipticCurvePublicKey, days: int
) -> x509.CertificateBuilder:
    now = datetime.datetime.now(datetime.UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(public)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - EARLIER)
        .not_valid_after(now + datetime.timedelta(days=days))
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(public), critical=False)
    )


def _usage(sign: bool) -> x509.KeyUsage:
    """Of an authority's key, or of one that only proves who somebody is."""
    return x509.KeyUsage(
        digital_signature=not sign,
        key_cert_sign=sign,
        crl_sign=sign,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )


def _name(common_name: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common_name[:64])])


def _general_name(host: str) -> x509.GeneralName:
    """The name or address of a host as certificates have it."""
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        pass
    try:
        return x509.DNSName(host)
    except ValueError:
        raise InputError(f"--host {host}", "no name of a host", "a DNS name or an address") from None


def _pem(key: ec.EllipticCurvePrivateKey) -> bytes:
    form, none = serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    return key.private_bytes(serialization.Encoding.PEM, form, none)


def _write(path: Path, data: bytes) -> None:
    """Write a file that only its owner can read, whole or not at all."""
    new = path.with_name(f"{path.name}.new")
    with explained(path, "a folder that can be written"):
        new.unlink(missing_ok=True)
        descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with open(descriptor, "wb") as file:
            file.write(data)
        new.replace(path)
