"""The certificate of one process, as `onehop keys` makes it: found, checked, and told to Zenoh.

A folder of keys has a folder for each process, with all that this process needs and nothing else, so
that it can be copied to another host by itself. Zenoh says no more than "timeout" about a certificate
that is refused, so what a host can see of its own is looked at before.
"""

import datetime
from pathlib import Path
from typing import Any

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives import serialization
from cryptography.x509.oid import NameOID

from onehop.contracts.errors import InputError
from onehop.contracts.printable import printable
from onehop.node.identity import AUTHORITY, CERTIFICATE, KEY, Certificate


def own_certificate(keys: Path, name: str) -> Certificate:
    """The certificate of a process in a folder of keys. Raises InputError when it is of no use."""
    folder = (keys / name).absolute()
    authority = _certificate(folder / AUTHORITY)
    own = _certificate(folder / CERTIFICATE)
    path = str(folder / CERTIFICATE)
    try:
        own.verify_directly_issued_by(authority)
    except (InvalidSignature, ValueError, TypeError):
        whole = "one folder, made by one onehop keys, copied as a whole"
        raise InputError(path, f"not signed by the authority in {AUTHORITY}", whole) from None
    common = [str(one.value) for one in own.subject.get_attributes_for_oid(NameOID.COMMON_NAME)]
    if common != [name]:
        raise InputError(path, f"is that of {printable(', '.join(common), 60)}", f"one of {name}")
    again = f"onehop keys DIR --reissue {name} where the authority's key is"
    now = datetime.datetime.now(datetime.UTC)
    if now > own.not_valid_after_utc:
        raise InputError(path, f"expired on {own.not_valid_after_utc:%Y-%m-%d}", again)
    if now < own.not_valid_before_utc:
        since = f"not valid before {own.not_valid_before_utc:%Y-%m-%d %H:%M} UTC"
        raise InputError(path, since, "see that the clock of this host is right")
    if _public(_private_key(folder / KEY)) != _public(own):
        raise InputError(str(folder / KEY), f"is not the key to {CERTIFICATE}", again)
    return Certificate(name, folder, hosts_of(own), own.not_valid_after_utc)


def hosts_of(certificate: x509.Certificate) -> tuple[str, ...]:
    """Names and addresses that a certificate is good for as that of a router."""
    try:
        found = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return ()
    names = found.get_values_for_type(x509.DNSName)
    return (*names, *map(str, found.get_values_for_type(x509.IPAddress)))


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise InputError(
            str(path), why, "made by onehop keys; copy the folder of this process"
        ) from None


def _certificate(path: Path) -> x509.Certificate:
    try:
        return x509.load_pem_x509_certificate(_read(path))
    except ValueError:
        raise InputError(str(path), "is no certificate", "a PEM file made by onehop keys") from None


def _private_key(path: Path) -> Any:
    data = _read(path)
    if path.stat().st_mode & 0o077:
        raise InputError(str(path), "others may read or change it", f"chmod 600 {path}")
    try:
        return serialization.load_pem_private_key(data, password=None)
    except (ValueError, TypeError):
        raise InputError(str(path), "is no key", "a PEM file made by onehop keys") from None


def _public(owner: Any) -> bytes:
    encoding, form = serialization.Encoding.DER, serialization.PublicFormat.SubjectPublicKeyInfo
    public: bytes = owner.public_key().public_bytes(encoding, form)
    return public
