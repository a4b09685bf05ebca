# Made by packaging/homebrew/fill.py from the checksums of a release. Put it into the folder Formula of a tap.
class Vtex < Formula
  desc "Turn a photograph of a texture into an editable vector texture of any size"
  homepage "https://github.com/@REPOSITORY@"
  version "@VERSION@"
  license any_of: ["MIT", "Apache-2.0"]

  on_macos do
    on_arm do
      url "https://github.com/@REPOSITORY@/releases/download/v@VERSION@/vtex-aarch64-apple-darwin-v@VERSION@.tar.gz"
      sha256 "@aarch64-apple-darwin@"
    end
    on_intel do
      url "https://github.com/@REPOSITORY@/releases/download/v@VERSION@/vtex-x86_64-apple-darwin-v@VERSION@.tar.gz"
      sha256 "@x86_64-apple-darwin@"
    end
  end

  on_linux do
    on_arm do
      url "https://github.com/@REPOSITORY@/releases/download/v@VERSION@/vtex-aarch64-unknown-linux-gnu-v@VERSION@.tar.gz"
      sha256 "@aarch64-unknown-linux-gnu@"
    end
    on_intel do
      url "https://github.com/@REPOSITORY@/releases/download/v@VERSION@/vtex-x86_64-unknown-linux-gnu-v@VERSION@.tar.gz"
      sha256 "@x86_64-unknown-linux-gnu@"
    end
  end

  def install
    bin.install "vtex"
    man1.install Dir["man/*.1"]
    bash_completion.install "completions/vtex.bash" => "vtex"
    fish_completion.install "completions/vtex.fish"
    zsh_completion.install "completions/_vtex"
    doc.install "dependencies.html"
    pkgshare.install "terrazzo.png"
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/vtex --version")
    system bin/"vtex", "texture", pkgshare/"terrazzo.png", "-o", "terrazzo.svg", "--size", "300"
    assert_match 'id="primary"', File.read("terrazzo.svg")
  end
end
